# docker build --tag ivsid . && docker run --rm --volume "$PWD:/data" ivsid diagnose boat.toml run1.csv run2.csv
FROM rust:1.95-slim AS build
RUN apt-get update && apt-get install --yes --no-install-recommends python3-venv && python3 -m venv /venv && /venv/bin/pip install maturin==1.16.0
COPY . /src
RUN cd /src && /venv/bin/maturin build --release --locked --out /wheels
FROM python:3.13-slim
RUN --mount=type=bind,from=build,source=/wheels,target=/wheels pip install --no-cache-dir /wheels/*.whl && useradd --create-home ivsid
USER ivsid
WORKDIR /data
ENTRYPOINT ["ivsid"]
