"use strict";
// The 3-D view of a report: surfaces, fibers and obstacles at the load steps that the run has kept.
// Between two steps nothing is drawn: what is seen was computed.
(() => {
  const element = (name) => document.getElementById(name);
  const canvas = element("view");
  const message = element("view-message");

  function fail(text) {
    message.textContent = text;
    message.hidden = false;
    element("view-controls").hidden = true;
    canvas.hidden = true;
    element("view-axes").hidden = true;
  }

  async function unpacked(text, Type) {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    const planes = new Uint8Array(await new Response(stream).arrayBuffer());
    const size = Type.BYTES_PER_ELEMENT;
    if (size === 1) return new Type(planes.buffer);
    const count = planes.length / size;
    const ordered = new Uint8Array(planes.length);
    for (let plane = 0; plane < size; plane++) {
      for (let i = 0; i < count; i++) ordered[i * size + plane] = planes[plane * count + i];
    }
    return new Type(ordered.buffer);
  }

  const FIBER_LIFT = 0.25; // mm
  const FIBER_WIDTH = 0.4; // mm, as far as it can be seen

  // Colours as they are written, with a shade so faint that they can be read off the bar.
  const VERTEX = `
    attribute float value;
    varying float shown;
    varying float light;
    void main() {
      shown = value;
      vec3 turned = normalize(normalMatrix * normal);
      light = 0.86 + 0.14 * abs(turned.z);
      gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
    }`;
  const FRAGMENT = `
    uniform sampler2D colors;
    uniform float share;
    varying float shown;
    varying float light;
    void main() {
      float level = floor(min(shown * share, 1.0) * 255.0 + 0.5);
      vec3 color = texture2D(colors, vec2((level + 0.5) / 256.0, 0.5)).rgb;
      gl_FragColor = vec4(color * light, 1.0);
    }`;

  function palette(bytes) {
    const data = new Uint8Array(4 * 256).fill(255);
    for (let i = 0; i < 256; i++) data.set(bytes.subarray(3 * i, 3 * i + 3), 4 * i);
    const texture = new THREE.DataTexture(data, 256, 1);
    texture.needsUpdate = true;
    return texture;
  }

  /** A colour "#rrggbb" as three.js mixes it: red, green and blue in linear light. */
  function linear(color) {
    return [1, 3, 5].map((at) => {
      const part = parseInt(color.slice(at, at + 2), 16) / 255;
      return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
    });
  }

  /** The same lines, moved with them, that may have other colours. */
  function imageOf(geometry) {
    const image = new THREE.LineSegmentsGeometry();
    image.setAttribute("instanceStart", geometry.attributes.instanceStart);
    image.setAttribute("instanceEnd", geometry.attributes.instanceEnd);
    image.instanceCount = geometry.instanceCount;
    return image;
  }

  /** Give every piece of lines the colour of its family, at both ends. */
  function paint(geometry, family, colors) {
    const ends = new Float32Array(6 * family.length);
    family.forEach((number, piece) => {
      ends.set(colors[number], 6 * piece);
      ends.set(colors[number], 6 * piece + 3);
    });
    geometry.setColors(ends);
  }

  function regionColors(regions) {
    const bytes = new Uint8Array(3 * 256).fill(150);
    for (const region of regions) {
      const color = parseInt(region.color.slice(1), 16);
      bytes.set([color >> 16, (color >> 8) & 255, color & 255], 3 * region.number);
    }
    return bytes;
  }

  async function start() {
    const data = JSON.parse(element("scene-data").textContent);
    const scene = new THREE.Scene();
    const renderer = new THREE.WebGLRenderer({
      canvas, antialias: true, alpha: true, preserveDrawingBuffer: true,
    });
    renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    const camera = new THREE.OrthographicCamera();
    const controls = new THREE.OrbitControls(camera, canvas);
    controls.minZoom = 0.3;
    controls.maxZoom = 60;

    const scalarColors = Uint8Array.from(atob(data.colors), (letter) => letter.charCodeAt(0));
    const palettes = {
      scalar: palette(scalarColors), region: palette(regionColors(data.regions)),
    };
    const coloring = () => new THREE.ShaderMaterial({
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      uniforms: { colors: { value: palettes.scalar }, share: { value: 1 } },
      side: THREE.DoubleSide,
      polygonOffset: true,
    });

    // --- what is drawn ----------------------------------------------------------------------

    const place = (numbers, first, points, into) => {
      for (let i = 0; i < 3 * points; i++) {
        into[i] = data.corner[i % 3] + data.scale * numbers[3 * first + i];
      }
    };
    const both = (make) => {
      const whole = new THREE.Group();
      whole.add(make());
      if (data.half) {
        const image = make();
        image.scale.x = -1;
        whole.add(image);
      }
      scene.add(whole);
      return whole;
    };

    const skins = [];
    for (const skin of data.skins) {
      const geometry = new THREE.BufferGeometry();
      const points = new Float32Array(3 * skin.points);
      geometry.setAttribute("position", new THREE.BufferAttribute(points, 3));
      geometry.setIndex(new THREE.BufferAttribute(await unpacked(skin.triangles, Uint32Array), 1));
      const material = coloring();
      const make = () => {
        const mesh = new THREE.Mesh(geometry, material);
        mesh.frustumCulled = false;
        return mesh;
      };
      skins.push({
        ...skin,
        geometry,
        material,
        numbers: await unpacked(skin.positions, Uint16Array),
        byRegion: await unpacked(skin.region, Uint8Array),
        byQuantity: await Promise.all(skin.values.map((text) => unpacked(text, Uint8Array))),
        whole: both(make),
      });
    }

    let fibers = null;
    if (data.fibers.points) {
      const segments = await unpacked(data.fibers.segments, Uint32Array);
      const geometry = new THREE.LineSegmentsGeometry();
      geometry.setPositions(new Float32Array(3 * segments.length));
      const families = data.fibers.families;
      const family = families.length ? await unpacked(data.fibers.family, Uint8Array) : [];
      const geometries = families.length && data.half ? [geometry, imageOf(geometry)] : [geometry];
      if (families.length) {
        paint(geometry, family, families.map(({ color }) => linear(color)));
        const images = families.map(({ image }) => linear(families[image].color));
        if (data.half) paint(geometries[1], family, images);
      }
      const material = new THREE.LineMaterial({
        color: families.length ? 0xffffff : 0x1a1a1a, vertexColors: families.length > 0,
        linewidth: 1.4, side: THREE.DoubleSide,
      });
      let made = 0;
      fibers = {
        segments,
        material,
        numbers: await unpacked(data.fibers.positions, Uint16Array),
        points: new Float32Array(3 * data.fibers.points),
        geometry,
        whole: both(() => {
          const line = new THREE.LineSegments2(geometries[made++ % geometries.length], material);
          line.frustumCulled = false;
          return line;
        }),
      };
    }

    let fabric = null;
    if (data.fabric.points) {
      const { points, color } = data.fabric;
      const geometry = new THREE.BufferGeometry();
      const positions = new THREE.BufferAttribute(new Float32Array(3 * points), 3);
      geometry.setAttribute("position", positions);
      geometry.setAttribute("value", new THREE.BufferAttribute(new Uint8Array(points), 1, true));
      const index = await unpacked(data.fabric.triangles, Uint32Array);
      geometry.setIndex(new THREE.BufferAttribute(index, 1));
      const material = coloring();
      material.polygonOffset = false;
      material.uniforms.colors.value = palette(regionColors([{ number: 0, color }]));
      fabric = {
        points,
        geometry,
        numbers: await unpacked(data.fabric.positions, Uint16Array),
        whole: both(() => {
          const mesh = new THREE.Mesh(geometry, material);
          mesh.frustumCulled = false;
          return mesh;
        }),
      };
    }

    const obstacles = new THREE.Group();
    scene.add(obstacles);
    for (const obstacle of data.obstacles) {
      const geometry = new THREE.BufferGeometry();
      const points = await unpacked(obstacle.points, Float32Array);
      geometry.setAttribute("position", new THREE.BufferAttribute(points, 3));
      const index = await unpacked(obstacle.triangles, Uint32Array);
      geometry.setIndex(new THREE.BufferAttribute(index, 1));
      obstacles.add(new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({
        color: 0x8a8f98, transparent: true, opacity: 0.45, side: THREE.DoubleSide,
        depthWrite: false,
      })));
      obstacles.add(new THREE.LineSegments(
        new THREE.EdgesGeometry(geometry, 30), new THREE.LineBasicMaterial({ color: 0x5a6068 }),
      ));
    }

    // --- the state of the controls ------------------------------------------------------------

    const slider = element("step");
    const quantity = element("quantity");
    const checked = (name) => {
      const box = element(name);
      return box ? box.checked : false;
    };
    let shown = -1;
    let needed = true;

    function showStep(number) {
      shown = number;
      const step = data.steps[number];
      for (const moved of fabric ? [...skins, fabric] : skins) {
        const position = moved.geometry.getAttribute("position");
        place(moved.numbers, number * moved.points, moved.points, position.array);
        position.needsUpdate = true;
        moved.geometry.computeVertexNormals();
      }
      if (fibers) {
        const { points, segments, geometry } = fibers;
        place(fibers.numbers, (number * points.length) / 3, points.length / 3, points);
        const ends = geometry.attributes.instanceStart.data;
        for (let i = 0; i < segments.length; i++) {
          ends.array.set(points.subarray(3 * segments[i], 3 * segments[i] + 3), 3 * i);
        }
        ends.needsUpdate = true;
      }
      showValues();
      const rounded = (value) => value.toFixed(1).replace(/^-0\.0$/, "0.0").replace("-", "−");
      const state = `step ${step.step}: ${rounded(step.pressure)} kPa, θ = ${rounded(step.angle)}°`;
      const text = step.forces ? `${state}; ${step.forces}` : state;
      element("step-text").textContent = text;
      slider.setAttribute("aria-valuetext", text);
      slider.value = String(number);
      needed = true;
    }

    function showValues() {
      const which = data.quantities.findIndex((each) => each.name === quantity.value);
      const top = greatest(which);
      for (const skin of skins) {
        skin.material.uniforms.colors.value = which < 0 ? palettes.region : palettes.scalar;
        skin.material.uniforms.share.value = which < 0 ? 1 : skin.tops[which] / top;
        const all = which < 0 ? skin.byRegion : skin.byQuantity[which];
        const first = which < 0 ? 0 : shown * skin.points;
        const values = all.subarray(first, first + skin.points);
        skin.geometry.setAttribute("value", new THREE.BufferAttribute(values, 1, true));
      }
      element("bar").hidden = which < 0;
      element("regions").hidden = which >= 0;
      if (which >= 0) drawBar(data.quantities[which], top);
      needed = true;
    }

    // The colours span what is seen from outside, and what a cut shows where it is cut open.
    function greatest(which) {
      const cut = checked("show-cut");
      const sheath = checked("show-sheath");
      const seen = skins.filter((skin) => cut
        ? (skin.part === "sheath" ? sheath : checked("show-body"))
        : !skin.cut && (skin.part === "sheath") === sheath);
      const tops = (seen.length ? seen : skins).map((skin) => skin.tops[which]);
      return Math.max(...tops);
    }

    function showParts() {
      const cut = checked("show-cut");
      for (const skin of skins) {
        const part = skin.part === "sheath" ? checked("show-sheath") : checked("show-body");
        skin.whole.visible = part && (cut || !skin.cut);
        if (skin.whole.children[1]) skin.whole.children[1].visible = !cut;
      }
      if (fibers) {
        fibers.whole.visible = checked("show-fibers");
        if (fibers.whole.children[1]) fibers.whole.children[1].visible = !cut;
      }
      if (fabric) {
        fabric.whole.visible = checked("show-fabric");
        if (fabric.whole.children[1]) fabric.whole.children[1].visible = !cut;
      }
      obstacles.visible = checked("show-obstacles");
      showValues();
    }

    function drawBar({ label, powers }, top) {
      const bar = element("bar-colors");
      const context = bar.getContext("2d");
      for (let i = 0; i < 256; i++) {
        context.fillStyle = `rgb(${scalarColors.subarray(3 * i, 3 * i + 3).join(",")})`;
        context.fillRect(i, 0, 1, 1);
      }
      element("bar-label").textContent = label;
      const ticks = element("bar-ticks");
      ticks.replaceChildren(...[0, 1, 2, 3, 4].map((i) => {
        const tick = document.createElement("span");
        const value = powers ? top * 10 ** (powers * (i / 4 - 1)) : (i * top) / 4;
        const sign = i === 4 ? "≥ " : i === 0 && powers ? "≤ " : "";
        tick.textContent = sign + String(Number(value.toPrecision(3)));
        tick.style.left = `${25 * i}%`;
        return tick;
      }));
    }

    // --- from where it is seen ------------------------------------------------------------------

    const low = new THREE.Vector3(...data.bounds[0]);
    const high = new THREE.Vector3(...data.bounds[1]);
    const reach = low.distanceTo(high);
    let all = false;
    const views = {
      side: [-1, 0, 0], front: [0, 0, -1], top: [0, 1, 0.001], oblique: [-0.75, 0.42, -0.5],
    };

    function fit() {
      const width = canvas.clientWidth, height = canvas.clientHeight;
      if (!width || !height) return;
      renderer.setSize(width, height, false);
      if (fibers) fibers.material.resolution.set(width, height);
      // the whole motion fits, seen from where it is
      camera.updateMatrixWorld();
      const right = new THREE.Vector3(), up = new THREE.Vector3(), back = new THREE.Vector3();
      camera.matrixWorld.extractBasis(right, up, back);
      let across = 0, tall = 0;
      for (let i = 0; i < 8; i++) {
        const corner = new THREE.Vector3(
          i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z,
        ).sub(controls.target);
        across = Math.max(across, Math.abs(corner.dot(right)));
        tall = Math.max(tall, Math.abs(corner.dot(up)));
      }
      const half = 1.06 * Math.max(tall, (across * height) / width);
      camera.top = half;
      camera.bottom = -half;
      camera.right = (half * width) / height;
      camera.left = -camera.right;
      camera.near = 0;
      camera.far = 6 * reach;
      // fibers lie in a surface that is drawn flat between its points: it steps back behind them
      const behind = (FIBER_LIFT / camera.far) * 2 ** 24;
      for (const skin of skins) skin.material.polygonOffsetUnits = behind;
      camera.updateProjectionMatrix();
      needed = true;
    }

    function aim(least, greatest) {
      low.copy(least);
      high.copy(greatest);
      const toward = camera.position.clone().sub(controls.target).normalize();
      controls.target.copy(low).add(high).multiplyScalar(0.5);
      camera.position.copy(controls.target).addScaledVector(toward, 3 * reach);
      camera.zoom = 1;
      controls.update();
      fit();
    }

    function withObstacles(box) {
      const beside = new THREE.Vector3(1, 1, 1).multiplyScalar(data.around);
      const least = box[0].clone().sub(beside), greatest = box[1].clone().add(beside);
      if (!obstacles.visible) return box;
      for (const drawn of obstacles.children) {
        const points = drawn.geometry.getAttribute("position");
        for (let i = 0; i < points.count; i++) {
          const point = new THREE.Vector3().fromBufferAttribute(points, i);
          point.clamp(least, greatest);
          box[0].min(point);
          box[1].max(point);
        }
      }
      return box;
    }

    // all steps, or the one that is shown
    function fitAll() {
      all = true;
      aim(...withObstacles(data.bounds.map((corner) => new THREE.Vector3(...corner))));
    }

    function fitStep() {
      all = false;
      const box = [new THREE.Vector3(1, 1, 1), new THREE.Vector3(-1, -1, -1)];
      box.forEach((corner) => corner.multiplyScalar(1e9));
      for (const skin of skins) {
        const points = skin.geometry.getAttribute("position");
        for (let i = 0; i < points.count; i++) {
          const point = new THREE.Vector3().fromBufferAttribute(points, i);
          box[0].min(point);
          box[1].max(point);
          if (data.half) box[0].x = Math.min(box[0].x, -point.x);
        }
      }
      aim(...withObstacles(box));
    }

    function look(name) {
      camera.position.copy(controls.target).addScaledVector(
        new THREE.Vector3(...views[name]).normalize(), 3 * reach,
      );
      if (all) fitAll();
      else fitStep();
      camera.lookAt(controls.target);
      controls.update();
      fit();
    }

    function turn(across, up) {
      const offset = camera.position.clone().sub(controls.target);
      const place = new THREE.Spherical().setFromVector3(offset);
      place.theta += across;
      place.phi = Math.min(Math.max(place.phi + up, 0.001), Math.PI - 0.001);
      camera.position.copy(controls.target).add(offset.setFromSpherical(place));
      controls.update();
      needed = true;
    }

    function zoom(factor) {
      camera.zoom = Math.min(Math.max(camera.zoom * factor, controls.minZoom), controls.maxZoom);
      camera.updateProjectionMatrix();
      needed = true;
    }

    const STEP = Math.PI / 36;
    const keys = {
      ArrowLeft: () => turn(-STEP, 0), ArrowRight: () => turn(STEP, 0),
      ArrowUp: () => turn(0, -STEP), ArrowDown: () => turn(0, STEP),
      "+": () => zoom(1.15), "=": () => zoom(1.15), "-": () => zoom(1 / 1.15),
      Home: () => look("side"),
    };
    canvas.addEventListener("keydown", (event) => {
      const action = keys[event.key];
      if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      action();
    });

    // axes and a scale, in a corner
    function drawAxes() {
      const corner = element("view-axes");
      const context = corner.getContext("2d");
      const ratio = Math.min(window.devicePixelRatio || 1, 2);
      const width = 170, height = 84;
      if (corner.width !== width * ratio) {
        corner.width = width * ratio;
        corner.height = height * ratio;
      }
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      context.clearRect(0, 0, width, height);
      const ink = getComputedStyle(document.body).color;
      context.strokeStyle = context.fillStyle = ink;
      context.font = "13px sans-serif";
      context.textAlign = "center";
      context.textBaseline = "middle";
      context.lineWidth = 1.5;
      for (const [name, axis] of [["x", [1, 0, 0]], ["y", [0, 1, 0]], ["z", [0, 0, 1]]]) {
        const seen = new THREE.Vector3(...axis).transformDirection(camera.matrixWorldInverse);
        if (Math.hypot(seen.x, seen.y) < 0.08) continue;
        context.beginPath();
        context.moveTo(38, 44);
        context.lineTo(38 + 24 * seen.x, 44 - 24 * seen.y);
        context.stroke();
        context.fillText(name, 38 + 33 * seen.x, 44 - 33 * seen.y);
      }
      const pixel = (camera.right - camera.left) / camera.zoom / canvas.clientWidth;
      const power = 10 ** Math.floor(Math.log10(70 * pixel));
      const length = [5, 2, 1].find((n) => n * power <= 70 * pixel) * power;
      context.fillRect(84, 62, length / pixel, 3);
      context.fillText(`${Number(length.toPrecision(2))} mm`, 84 + length / pixel / 2, 48);
    }

    // --- what the reader does --------------------------------------------------------------------

    slider.max = String(data.steps.length - 1);
    // the first picture is as large as the frame; who goes through the steps sees all at one scale
    const go = (number) => {
      if (!all && !chosen && camera.zoom === 1) fitAll();
      showStep(number);
    };
    let chosen = false;
    slider.addEventListener("input", () => { stop(); go(Number(slider.value)); });
    quantity.addEventListener("change", showValues);
    for (const box of document.querySelectorAll("#view-controls input[type=checkbox]")) {
      box.addEventListener("change", showParts);
    }
    for (const button of document.querySelectorAll("[data-look]")) {
      button.addEventListener("click", () => look(button.dataset.look));
    }
    element("fit-step").addEventListener("click", () => { chosen = true; fitStep(); });
    element("fit-all").addEventListener("click", fitAll);
    const play = element("play");
    let timer = 0;
    function stop() {
      clearInterval(timer);
      timer = 0;
      play.textContent = "Play";
    }
    play.addEventListener("click", () => {
      if (timer) return stop();
      play.textContent = "Pause";
      go(shown === data.steps.length - 1 ? 0 : shown);
      timer = setInterval(() => {
        if (shown >= data.steps.length - 1) return stop();
        showStep(shown + 1);
      }, Math.min(600, Math.max(80, 5000 / data.steps.length)));
    });
    controls.addEventListener("change", () => { needed = true; });
    new ResizeObserver(fit).observe(canvas);

    showStep(data.steps.length - 1);
    showParts();
    look("side");
    (function draw() {
      requestAnimationFrame(draw);
      if (!needed) return;
      needed = false;
      if (fibers) {
        const pixel = (camera.right - camera.left) / camera.zoom / canvas.clientWidth;
        fibers.material.linewidth = Math.min(Math.max(FIBER_WIDTH / pixel, 0.7), 6);
      }
      renderer.render(scene, camera);
      drawAxes();
      canvas.dataset.drawn = `${shown}`;
    })();
  }

  if (typeof DecompressionStream === "undefined") {
    fail("This browser is too old for the view in space: the pictures below show the body.");
    return;
  }
  start().catch((error) => fail(`The view in space cannot be drawn here: ${error.message}`));
})();
