# Builds hallsweep, then keeps only the program.
#   docker build -t hallsweep .
#   docker run --name hallsweep -p 8080:8080 -v hallsweep:/data hallsweep
#   docker logs hallsweep             the first start prints a link there to sign in with
#   docker exec hallsweep hallsweep token          shows it again, and makes keys for others
# What passes through the port is not encrypted: on a network with strangers put a certificate into the container
# (HALLSWEEP__HTTP__TLS_CERTIFICATE, HALLSWEEP__HTTP__TLS_KEY), or publish on loopback and let a proxy encrypt.

FROM rust:1-slim-bookworm AS build
WORKDIR /build
COPY Cargo.toml Cargo.lock build.rs ./
COPY benches ./benches
# Named in Cargo.toml too, so cargo wants to see it.
COPY tests ./tests
COPY config ./config
COPY templates ./templates
COPY static ./static
COPY src ./src
COPY crates ./crates
RUN cargo build --release --locked --bin hallsweep

FROM debian:bookworm-slim
# The times on photos and in the log are shown in the zone of TZ, as `-e TZ=Europe/Rome`; the zones come from here.
RUN apt-get update \
 && apt-get install -y --no-install-recommends tzdata \
 && rm -rf /var/lib/apt/lists/* \
 && useradd --system --no-create-home --shell /usr/sbin/nologin hallsweep \
 && install -d -o hallsweep -g hallsweep -m 0700 /data
COPY --from=build /build/target/release/hallsweep /usr/local/bin/hallsweep
USER hallsweep
# Keys, records and photos; a container without a volume of its own here forgets them with itself.
ENV HALLSWEEP__STORE__FOLDER=/data
VOLUME /data
# 5683/udp is CoAP, and off for others by default: it listens on the container's own loopback, so that publishing the port alone
# opens nothing. With HALLSWEEP__COAP__BIND=0.0.0.0:5683 and HALLSWEEP__COAP__OPEN_TO_OTHERS=true everybody who reaches the published
# port can read everything, unencrypted, and command nothing (docs/settings.md).
# So it is with 1883, MQTT; with HALLSWEEP__MQTT__BIND=0.0.0.0:1883 whoever comes shows a key's name and token (docs/mqtt.md).
EXPOSE 8080 1883 5683/udp
HEALTHCHECK --interval=10s --timeout=5s --start-period=5s --retries=3 CMD ["hallsweep", "healthcheck"]
ENTRYPOINT ["hallsweep"]
# Inside the container nobody but the container itself reaches its loopback, so it listens on every address of the container,
# and asks whoever comes for a key.
CMD ["serve", "--http", "0.0.0.0:8080"]
