# Every target does its own set-up in .venv, from locked dependencies. Needs Rust, Python 3.11 or later and a C compiler.
PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV := .venv
BIN := $(VENV)/bin
OUT ?= out/demo
RUST_SOURCES := $(shell find crates -name '*.rs' -o -name 'Cargo.toml') Cargo.toml Cargo.lock

.PHONY: demo test check bench vessels peers inverse-peers throughput exhaustive twins itf1788 differential fuzz exam handbook docs build format clean

demo: build
	$(BIN)/ivsid demo --out $(OUT)

test: build
	cargo test --locked
	$(BIN)/pytest -n auto

check: build
	cargo fmt --all --check
	cargo clippy --locked --workspace --all-targets -- -D warnings
	$(BIN)/ruff format --check python tests examples benches docs/*.py
	$(BIN)/ruff check python tests examples benches docs/*.py
	$(BIN)/mypy
	$(BIN)/stubtest ivsid._core --mypy-config-file pyproject.toml
	$(BIN)/lint-imports
	$(MAKE) docs

# An entry and a figure for every effect, from the catalogue, docs/handbook_words.toml and the simulator.
handbook: build
	$(BIN)/python docs/handbook.py

docs: build
	RUSTDOCFLAGS="-D warnings" cargo doc --locked --no-deps
	$(BIN)/sphinx-build -q -W --keep-going docs docs/_build/html

bench: build
	cargo bench --locked
	$(BIN)/python benches/ratios.py

# Every command on every real set; the sets are not part of this repository.
DATA ?= ../shared/data
vessels: build
	$(BIN)/python benches/real_data.py $(DATA) out/vessels

# inari beside this crate, built for two targets; GMP and MPFR are built from source (m4 is needed, some minutes).
peers:
	cd benches/peers && cargo run --release --locked --target-dir target/haswell
	cd benches/peers && RUSTFLAGS=-Ctarget-cpu=native cargo run --release --locked --target-dir target/native

# The conformance vectors of IEEE 1788; IVSID_ITF1788 names another folder.
itf1788:
	cargo test --locked --test itf1788 -- --nocapture conformance

# Operands of every function that are compared with MPFR, and of every back end that are compared with the operators.
CASES ?= 1e8
differential: build
	IVSID_CASES=$(CASES) $(BIN)/pytest -n auto tests/python/test_oracle.py
	IVSID_CASES=$(CASES) cargo test --locked --release --test slices

# Twins with a known truth, several vehicles, both kinds of rows and noise: is it inside? VERIFY=--verify proves each result, too.
TWINS ?= 500
twins: build
	$(BIN)/python tests/python/twins.py --twins $(TWINS) $(VERIFY)

# Inverses: verdicts on regularity by exact determinants, members of every family inside every enclosure; some minutes.
MATRICES ?= 1e5
exhaustive:
	IVSID_CASES=$(MATRICES) cargo test --locked --release --test regularity --test hull --test systems --test range --test inverse

# The sweep and the hulls beside peers that are installed; the figure of the sweep for the docs.
inverse-peers: build
	$(BIN)/python benches/inverse_peers.py

throughput: build
	cargo bench --locked --bench inverse -- sweep
	$(BIN)/python benches/throughput.py docs/throughput.png

# Seconds of mutated literals for the text parser.
SECONDS ?= 600
fuzz:
	IVSID_FUZZ_SECONDS=$(SECONDS) cargo test --locked --release --test fuzz_text -- --nocapture

build: $(VENV)/.built

format: build
	cargo fmt --all
	$(BIN)/ruff format python tests examples benches docs/*.py
	$(BIN)/ruff check --fix python tests examples benches docs/*.py

$(VENV)/.ready: requirements/lock.txt
	$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "Python 3.11 or later is needed; set PYTHON=/path/to/it")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check --requirement requirements/lock.txt
	touch $@

$(VENV)/.built: $(VENV)/.ready $(RUST_SOURCES) pyproject.toml
	VIRTUAL_ENV=$(abspath $(VENV)) $(BIN)/maturin develop --release --locked --quiet
	touch $@

clean:
	rm -rf $(VENV) target out docs/_build python/ivsid/*.so

# Drawn cases of the diagnosis, sealed, and their score, which becomes a page of the docs; an hour and a half for 1000 on two cores.
SEED ?= $(shell date +%s)
EXAM ?= 1000
exam: build
	$(BIN)/python -m tests.exam.run $(SEED) $(EXAM) out=out/exam.json table=docs/examination.md
