# Builds hallsweep, then keeps only the program.
#   docker build -t hallsweep .
#   docker run --rm -p 127.0.0.1:8080:8080 hallsweep
# Publish the port on loopback, as above: there is no access control yet, and `-p 8080:8080` would let everybody on the
# network command the robot.

FROM rust:1-slim-bookworm AS build
WORKDIR /build
COPY Cargo.toml Cargo.lock ./
COPY benches ./benches
COPY config ./config
COPY templates ./templates
COPY static ./static
COPY src ./src
RUN cargo build --release --locked --bin hallsweep

FROM debian:bookworm-slim
# The times on photos and in the log are shown in the zone of TZ, as `-e TZ=Europe/Rome`; the zones come from here.
RUN apt-get update \
 && apt-get install -y --no-install-recommends tzdata \
 && rm -rf /var/lib/apt/lists/* \
 && useradd --system --no-create-home --shell /usr/sbin/nologin hallsweep
COPY --from=build /build/target/release/hallsweep /usr/local/bin/hallsweep
USER hallsweep
EXPOSE 8080
HEALTHCHECK --interval=10s --timeout=5s --start-period=5s --retries=3 CMD ["hallsweep", "healthcheck"]
ENTRYPOINT ["hallsweep"]
# Inside the container nobody but the container itself reaches its loopback, so it listens on every address of the container;
# --insecure says that we know. Who reaches it from outside is decided by what `docker run -p` publishes.
CMD ["serve", "--http", "0.0.0.0:8080", "--insecure"]
