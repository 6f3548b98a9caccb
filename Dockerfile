# Builds an image that holds the program, what it needs of Debian, and nothing else. How it is run: docs/container.md.
#
#   docker build -t hallsweep .                               the image
#   docker build -t hallsweep --build-arg VARIANT=debug .     with a shell (busybox), and backtraces that name files and lines
#   docker buildx build --platform linux/amd64,linux/arm64 .  for both processors, on one machine and without an emulator
#
#   tools ─┬─► dependencies ─┬─► program ─┬─► files ─► the image
#          └─► writers ──────┴─► papers ──┘

# The present stable Debian. Its tag moves with Debian's own repairs, and a digest would keep them out: whoever must build the
# same image again gives one, as --build-arg DEBIAN=docker.io/library/debian@sha256:….
ARG DEBIAN=docker.io/library/debian:trixie-slim

# Rust; C, in which SQLite and ring are written; and what the program takes from Debian, for the processor that it is built for.
FROM --platform=$BUILDPLATFORM $DEBIAN AS tools
# Where Rust comes from, since that of the stable Debian itself is too old. It goes with DEBIAN.
ARG BACKPORTS=trixie-backports
# Set by the builder; one that does not builds for its own processor.
ARG TARGETARCH
ENV CARGO_HOME=/cargo
WORKDIR /build
RUN set -e; \
    arch=${TARGETARCH:-$(dpkg --print-architecture)}; \
    case $arch in \
      amd64) rust=x86_64-unknown-linux-gnu; gnu=x86_64-linux-gnu ;; \
      arm64) rust=aarch64-unknown-linux-gnu; gnu=aarch64-linux-gnu ;; \
      *) echo "hallsweep is built for amd64 and arm64, not for $arch" >&2; exit 1 ;; \
    esac; \
    debian=$(sed -n -E 's/^(URIs:|deb) +(https?:[^ ]+).*/\2/p' /etc/apt/sources.list /etc/apt/sources.list.d/* 2>/dev/null | head -n 1); \
    echo "deb $debian $BACKPORTS main" >/etc/apt/sources.list.d/backports.list; \
    dpkg --add-architecture $arch; \
    apt-get update; \
    apt-get install -y --no-install-recommends ca-certificates tzdata gcc libc6-dev gcc-$(echo $gnu | tr _ -) libc6-dev:$arch; \
    # Rust's compiler takes the library of its own version alone, and Debian may have a new Rust for one processor days before the other.
    newest() { apt-cache -t $BACKPORTS policy $1 | sed -n 's/^ *Candidate: //p'; }; \
    if [ "$(newest rustc)" != "$(newest libstd-rust-dev:$arch)" ]; then \
      echo "Debian has Rust $(newest rustc) for $(dpkg --print-architecture), and $(newest libstd-rust-dev:$arch) for $arch: until they are the same, build on $arch itself" >&2; \
      exit 75; \
    fi; \
    apt-get install -y --no-install-recommends -t $BACKPORTS cargo rustc libstd-rust-dev:$arch; \
    rm -rf /var/lib/apt/lists/*; \
    mkdir .cargo; \
    { echo "[build]"; \
      echo "target = '$rust'"; \
      # Of the folders here nothing is to be in the program.
      echo "rustflags = ['--remap-path-prefix=/build/=', '--remap-path-prefix=/cargo/registry/src/=']"; \
      echo "[target.$rust]"; \
      echo "linker = '$gnu-gcc'"; \
    } >.cargo/config.toml; \
    echo "arch=$arch rust=$rust gnu=$gnu" >target-of-build

# What writes the papers, below. Both are used once: compiling them well would take longer than it saves.
FROM tools AS writers
RUN export CARGO_PROFILE_DEV_DEBUG=false CARGO_BUILD_TARGET=$(rustc --print host-tuple) \
 && CARGO_PROFILE_DEV_OPT_LEVEL=1 cargo install --locked --debug --root /writers --features cli cargo-about@0.9.3 \
 && cargo install --locked --debug --root /writers cargo-cyclonedx@0.5.9

# What others wrote. None of our sources is here yet, so it is built anew only when Cargo.lock or a manifest changes. Tests and
# benches are no part of the image: the manifests do without them.
FROM tools AS dependencies
# Files and lines for backtraces. Only the image with VARIANT=debug keeps them.
ENV CARGO_PROFILE_RELEASE_DEBUG=line-tables-only
# `check` finds out whether it can be built, and goes no further than the stage `program`.
ARG COMPILE=build
COPY Cargo.toml Cargo.lock build.rs ./
COPY crates/behaviour-trees/Cargo.toml crates/behaviour-trees/
COPY crates/coap/Cargo.toml crates/coap/
COPY crates/core/Cargo.toml crates/core/
COPY crates/drivers/Cargo.toml crates/drivers/
COPY crates/evaluation/Cargo.toml crates/evaluation/
COPY crates/laboratory/Cargo.toml crates/laboratory/
COPY crates/mqtt/Cargo.toml crates/mqtt/
COPY crates/sim/Cargo.toml crates/sim/
RUN sed -i '/^\[\[\(test\|bench\)\]\]$/,/^$/d' Cargo.toml crates/*/Cargo.toml \
 && for package in . crates/*; do mkdir -p $package/src && touch $package/src/lib.rs || exit 1; done \
 && echo 'fn main() {}' >src/main.rs \
 && cargo $COMPILE --release --locked --bin hallsweep

# What goes with a program that holds the work of others: their licences in full, and the list of its parts (SBOM).
FROM dependencies AS papers
COPY --from=writers /writers/bin/ /usr/local/bin/
RUN cargo fetch --locked
COPY config/container/licences.toml config/container/licences.hbs /tmp/
RUN . ./target-of-build \
 && mkdir /papers \
 && cargo about generate --frozen --fail --config /tmp/licences.toml --output-file /papers/licences.txt /tmp/licences.hbs \
 && cargo cyclonedx --format json --spec-version 1.5 --no-build-deps --target $rust --override-filename sbom.cdx \
 && mv sbom.cdx.json /papers/ \
 && cp /usr/share/doc/libstd-rust-dev/copyright /papers/rust-standard-library.txt

FROM dependencies AS program
ARG COMPILE=build
COPY config/default.toml config/
COPY config/behaviours config/behaviours
COPY config/halls config/halls
COPY templates ./templates
COPY static ./static
COPY crates ./crates
COPY src ./src
# The real sources are older than what was made of the empty ones, and cargo goes by that.
RUN sed -i '/^\[\[\(test\|bench\)\]\]$/,/^$/d' crates/*/Cargo.toml \
 && find src crates -name '*.rs' -exec touch {} + \
 && cargo $COMPILE --release --locked --bin hallsweep

# Everything that stands in the image.
FROM program AS files
ARG VARIANT=plain
COPY LICENSE-APACHE LICENSE-MIT static/vendor/idiomorph.LICENSE static/vendor/inter.LICENSE static/vendor/lucide.LICENSE /papers/
COPY --from=papers /papers /papers
RUN set -e; \
    . ./target-of-build; \
    umask 022; \
    program=$PWD/target/$rust/release/hallsweep; \
    mkdir /image; \
    cd /image; \
    mkdir -p etc/ssl/certs tmp usr/bin usr/lib/$gnu usr/lib64 usr/share/doc var/lib/dpkg/status.d; \
    chmod 1777 tmp; \
    ln -s usr/bin usr/lib usr/lib64 .; \
    cp /usr/lib/$gnu/libc.so.6 /usr/lib/$gnu/libm.so.6 /usr/lib/$gnu/libgcc_s.so.1 usr/lib/$gnu/; \
    # Where a program looks for what loads its libraries is said in it, and differs.
    case $arch in amd64) loads=usr/lib64 ;; *) loads=usr/lib ;; esac; \
    cp /usr/lib/$gnu/ld-linux-* $loads/; \
    cp /etc/ssl/certs/ca-certificates.crt etc/ssl/certs/; \
    cp -r /usr/share/zoneinfo usr/share/; \
    cp -r /papers usr/share/doc/hallsweep; \
    for package in libc6:$arch libgcc-s1:$arch tzdata ca-certificates; do \
      name=${package%:*}; \
      dpkg-query --status $package >var/lib/dpkg/status.d/$name; \
      install -D -m 644 /usr/share/doc/$name/copyright usr/share/doc/$name/copyright; \
    done; \
    echo 'hallsweep:x:65532:0:hallsweep:/data:/usr/sbin/nologin' >etc/passwd; \
    echo 'root:x:0:' >etc/group; \
    echo 'hosts: files dns' >etc/nsswitch.conf; \
    # Everything that outlives a container. It is the group's too: a cluster may make up any user, with the group 0.
    install -d -o 65532 -g 0 -m 2770 data; \
    if [ $VARIANT = debug ]; then \
      cp $program usr/bin/; \
      apt-get update; \
      cd /tmp; \
      apt-get download busybox-static:$arch; \
      dpkg-deb -x busybox-static_* busybox; \
      dpkg-deb --field busybox-static_* >/image/var/lib/dpkg/status.d/busybox-static; \
      install -D -m 644 busybox/usr/share/doc/busybox-static/copyright /image/usr/share/doc/busybox-static/copyright; \
      cp busybox/usr/bin/busybox /image/usr/bin/; \
      ln -s busybox /image/usr/bin/sh; \
    else \
      $gnu-strip -o usr/bin/hallsweep $program; \
    fi

FROM scratch
ARG REVISION=unknown
LABEL org.opencontainers.image.title=hallsweep \
      org.opencontainers.image.description="A robot searches an evacuated airport hall for dangerous luggage; an operator watches, decides and can always stop it." \
      org.opencontainers.image.version=0.1.0 \
      org.opencontainers.image.revision=$REVISION \
      org.opencontainers.image.licenses="MIT OR Apache-2.0"
COPY --from=files /image/ /
ENV PATH=/usr/bin
# Keys, records and photos: a container is given a volume of its own here.
ENV HALLSWEEP__STORE__FOLDER=/data
VOLUME /data
WORKDIR /data
# Every address of the container, since nobody but itself reaches its loopback: whoever comes is asked for a key. It stands here
# and not in a flag, so that the health check and `hallsweep token` know of whatever it is set to.
ENV HALLSWEEP__HTTP__BIND=0.0.0.0:8080
# 1883 is MQTT, which listens on the container's loopback until it is given another address. Others may share that loopback, as in
# a pod, so that everybody is asked for a key there too. 5683/udp is CoAP, which has no keys, and is not there until it is asked for.
ENV HALLSWEEP__MQTT__REQUIRE_PASSWORD=true HALLSWEEP__COAP__BIND=none
EXPOSE 8080 1883 5683/udp
# By its number, so that a cluster can see that it is not root.
USER 65532:0
HEALTHCHECK --interval=10s --timeout=5s --start-period=5s --retries=3 CMD ["hallsweep", "healthcheck"]
ENTRYPOINT ["hallsweep"]
