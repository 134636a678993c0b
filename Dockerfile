# fiberbend on Debian 13. `make test-image` follows this file without Docker and uses what it makes.
#
#     docker build --tag fiberbend .
#     docker run --rm --volume "$PWD:/data" fiberbend run case.yaml
FROM debian:trixie-slim

# What changes seldom comes first: a layer is built again only where what it copies has changed.
WORKDIR /opt/fiberbend
COPY apt-packages.txt ./
RUN apt-get update -q \
    && xargs -a apt-packages.txt \
        env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends \
    && rm -rf /var/lib/apt/lists/*

# What the program needs, without what its tests do; pip must leave Debian's numpy in its place.
COPY constraints-debian13.txt requirements.txt pyproject.toml ./
RUN python3 -c 'import tomllib; project = tomllib.load(open("pyproject.toml", "rb"))["project"]; print(*project["dependencies"], sep="\n")' > needed.txt \
    && python3 -m venv --system-site-packages .venv \
    && .venv/bin/pip install -q --no-cache-dir --disable-pip-version-check \
        --constraint constraints-debian13.txt --requirement needed.txt

COPY . source
RUN .venv/bin/pip install -q --no-cache-dir --disable-pip-version-check \
        --no-deps --no-build-isolation ./source

# The first user of a machine often has this number: files in /data are then theirs. Kernels are
# compiled when a case is run, and kept in /var/cache/fiberbend: a volume there outlives the container.
RUN useradd --uid 1000 --create-home fiberbend \
    && install -d -o fiberbend -g fiberbend -m 755 /data \
    && install -d -o fiberbend -g fiberbend -m 700 /var/cache/fiberbend

# mpirun: more ranks than cores, also as root. Where a container forbids one rank to read the memory
# of another, Open MPI 5 goes another way by itself.
ENV PATH=/opt/fiberbend/.venv/bin:/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin \
    XDG_CACHE_HOME=/var/cache/fiberbend \
    OMPI_ALLOW_RUN_AS_ROOT=1 \
    OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
    PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe
USER fiberbend
WORKDIR /data
ENTRYPOINT ["fiberbend"]
CMD ["--help"]
