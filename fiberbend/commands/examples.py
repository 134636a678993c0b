"""Examples of the commands that are loaded when they are called, as their help shows them."""

EXAMPLES = {
    "control": """Examples:
  fiberbend control cases/free_bending.yaml
  fiberbend control cases/free_bending.yaml --supply "180 kPa" --noise "0.5 kPa"
  fiberbend control cases/section.yaml --steps "30 deg" "90 deg"
""",
    "plot": """Examples:
  fiberbend plot runs/section
  fiberbend plot runs/section --format svg --width 85mm --font-size 7
  fiberbend plot runs/section runs/thick --label "wall 2 mm" --label "wall 3 mm" --out walls.pdf
  fiberbend plot runs/section --measured angles.csv --open
  fiberbend plot runs/radius_length_wall --x wall_mm --y pressure_360deg_kPa
""",
    "init": """Examples:
  fiberbend init finger.yaml
  fiberbend init finger.yaml --radius 6.35mm --length 80mm --wall 2mm dragon-skin-30
  fiberbend init finger.yaml --section rectangle --width 20mm --height 10mm --pressure "80 kPa"
""",
    "cases": """Examples:
  fiberbend cases
  fiberbend cases section sweeps/angle_at_pressure
  fiberbend cases --all --out examples
""",
    "materials": """Examples:
  fiberbend materials
  fiberbend materials --kind thread
  fiberbend materials dragon-skin-10
  fiberbend materials dragon-skin-10 --plot dragon-skin-10.png
""",
    "show": """Examples:
  fiberbend show cases/free_bending.yaml --open
  fiberbend show cases/grasp.yaml --set actuator.radius="10 mm" --out grasp.png
""",
    "mesh": """Examples:
  fiberbend mesh cases/free_bending.yaml --out body.msh
  fiberbend mesh cases/cell.yaml --out cell.vtu
  fiberbend mesh cases/section.yaml --out section.inp --overwrite
""",
    "accuracy": """Examples:
  fiberbend accuracy cases/free_bending.yaml --dry-run
  fiberbend accuracy cases/free_bending.yaml --within 30s
  fiberbend accuracy cases/section.yaml --only section --only cell
""",
    "fit": """Examples:
  fiberbend fit dragon-skin-30 --upto "stretch 2"
  fiberbend fit tensile.csv --law yeoh-2,ogden-1 --as engineering --out my-rubber.yaml
  fiberbend fit tensile.csv --strain 1 --stress "2 [kPa]" --as true --cycle 3
  fiberbend fit --uniaxial a.csv --pure-shear b.csv --equibiaxial c.csv --law ogden
  fiberbend fit dragon-skin-30 --upto "stretch 2" --case cases/section.yaml --part wall
""",
    "design": """Examples:
  fiberbend design cases/designs/bend_at_pressure.yaml
  fiberbend design cases/designs/blocked_force.yaml --set actuator.length="80 mm"
""",
    "frequencies": """Examples:
  fiberbend frequencies cases/swing.yaml
  fiberbend frequencies cases/swing.yaml --at "0 kPa" --at "25 kPa" --modes 5
""",
    "hand": """Examples:
  fiberbend hand cases/hands/three_fingers.yaml
  fiberbend hand cases/hands/three_fingers.yaml --set actuator.wall="3 mm" --out runs/thick
""",
    "table": """Examples:
  fiberbend table cases/section.yaml
  fiberbend table cases/section.yaml --error 0.5% --from "10 kPa" --out law
  fiberbend table cases/circle.yaml --set actuator.wall="3 mm"
""",
    "export": """Examples:
  fiberbend export runs/section --to mujoco
  fiberbend export cases/section.yaml --to pyelastica --density floor="1.3 g/cm^3"
  fiberbend export runs/section --to json --out rods/section --overwrite
""",
    "report": """Examples:
  fiberbend report runs/section --open
  fiberbend report runs/section --out section.html
  fiberbend report runs/radius_length_wall
""",
}
