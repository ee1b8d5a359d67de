# A container with limner in it, and its kernels compiled: the first picture starts without the compiler.
#
#     docker build -t limner .
#     docker run --rm -v "$PWD:/work" limner render model.glb -o picture.png
#
# Code is made for any CPU of the architecture, for nobody knows which one an image will meet. Where all machines have AVX2,
# `--build-arg CPU_NAME=x86-64-v3` makes it faster; the pictures are the same to the bit.

FROM python:3.13-slim

ARG CPU_NAME=generic
ENV NUMBA_CPU_NAME=${CPU_NAME} \
    NUMBA_CPU_FEATURES="" \
    LIMNER_CACHE_DIR=/var/cache/limner \
    PYTHONDONTWRITEBYTECODE=1

# The package is compiled to bytecode by pip; nothing else is kept of the sources.
COPY pyproject.toml README.md LICENSE /source/
COPY src /source/src
RUN pip install --no-cache-dir "/source[formats]" && rm -rf /source

# A layer of its own, made by whoever will read it: root owns nothing that a picture needs to write.
RUN useradd --create-home limner && install -d -o limner -g limner /var/cache/limner /work
USER limner
RUN limner warmup && chmod -R a+rX /var/cache/limner

WORKDIR /work
ENTRYPOINT ["limner"]
CMD ["--help"]
