# pcavr from source on Debian 12, in two stages: the second has the command alone, with what it needs.
#   docker build -t pcavr .
#   docker run --rm -v "$PWD:/work" pcavr build my_recording -o my_scene
FROM debian:bookworm AS build
COPY . /source
WORKDIR /source
RUN scripts/build-packages

FROM debian:bookworm-slim
COPY --from=build /source/out/packages/pcavr_*.deb /packages/
RUN apt-get update -qq \
  && apt-get install -y -qq --no-install-recommends /packages/pcavr_*.deb \
  && rm -rf /packages /var/lib/apt/lists/*
WORKDIR /work
ENTRYPOINT ["pcavr"]
