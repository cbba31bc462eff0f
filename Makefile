# Every target does its own set-up in .venv, from locked dependencies. Needs Rust, Python 3.11 or later and a C compiler.
PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV := .venv
BIN := $(VENV)/bin
OUT ?= out/demo
# An environment may forbid Python to keep what it compiles. Every process would then compile all that it imports, which takes seconds.
unexport PYTHONDONTWRITEBYTECODE
RUST_SOURCES := $(shell find crates -name '*.rs' -o -name 'Cargo.toml') Cargo.toml Cargo.lock

# Cargo's profile of the gate (Cargo.toml). Tests, wheel, clippy and rustdoc name the same crates, so that they ask the
# dependencies for the same features, and those are compiled once.
GATE := --profile gate --locked
CRATES := --workspace --exclude benches
# Two workers on two cores leave none for the threads of a matrix product. The draws of proptest are those of a fixed seed.
ONE_THREAD := OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1
FIXED := PROPTEST_RNG_SEED=1

.PHONY: demo test test-rust test-python dependencies check rustfmt clippy lint rules null-logs constants constants-page rules-page rule-counts types stubs imports docs-rust docs-python nightly \
	site links workflows wheel try-wheel licences long-logs memcheck address bench bench-save bench-compare all-peers same same-compare vessels no-std peers inverse-peers fit-peers throughput diagnosis-time first-diagnosis plans refuted tubes stores fleet-throughput exhaustive twins itf1788 differential fuzz fuzz-files mutants exam reliability handbook build release venv tools format clean

demo: release
	$(BIN)/ivsid demo --out $(OUT)

# The example of the tutorial, its diagnosis, and the picture of README.md.
first-diagnosis: release
	$(BIN)/ivsid example out/first
	$(BIN)/ivsid diagnose out/first/boat.toml out/first/run1.csv out/first/run2.csv --out out/first/found
	cp out/first/found/signature_1.png docs/first_diagnosis.png

# Effects that contradict a fit by rows, by tubes, by both: the table of docs/measurements.md.
refuted: release
	$(ONE_THREAD) $(BIN)/python benches/refuted.py

# A planned minute beside the library, and on twins: the table of docs/measurements.md.
plans: release
	$(ONE_THREAD) $(BIN)/python benches/plans.py

# Widths and times of tubes on the demo's vehicle, and the picture of README.md.
tubes: release
	$(BIN)/python benches/tubes.py docs/tube.png

test: build
	$(MAKE) --no-print-directory -j2 --output-sync=target test-rust test-python

# The core, and what any test needs of others, by way of the smallest test.
dependencies:
	cargo test $(GATE) $(CRATES) --no-run --test layers

test-rust:
	MAKEFLAGS= $(FIXED) cargo test $(GATE) $(CRATES)

test-python: build
	$(ONE_THREAD) $(BIN)/pytest -n auto --dist worksteal -m "not nightly"

check: rustfmt clippy lint rules types stubs imports site workflows

rustfmt:
	cargo fmt --all --check

clippy:
	cargo clippy $(GATE) --workspace --all-targets -- -D warnings
	cargo clippy $(GATE) -p interval-core --no-default-features -- -D warnings
	cargo clippy $(GATE) -p interval-core --no-default-features --features alloc -- -D warnings

lint: venv
	$(BIN)/ruff format --check python tests examples benches docs/*.py
	$(BIN)/ruff check python tests examples benches docs/*.py

# Commit subjects of the branch, and the number of times that the package says Any.
rules: venv
	$(BIN)/python tests/check_commits.py
	$(BIN)/python tests/check_any.py

types: venv
	$(BIN)/mypy

stubs: build
	$(BIN)/stubtest ivsid._core --mypy-config-file tests/stubs.toml

imports: build
	$(BIN)/lint-imports

# An entry and a figure for every effect, from the catalogue, docs/handbook_words.toml and the simulator.
handbook: build
	$(BIN)/python docs/handbook.py

# The page of all numbers that the package decides by, from the comments beside them.
constants-page: venv
	$(BIN)/python docs/constants.py

# The page of the rules of the diagnosis.
rules-page: venv
	$(BIN)/python docs/rules.py

# Largest scores without an effect: Gaussian draws, simulated null logs and fresh logs side by side.
null-logs: release
	$(BIN)/python benches/null_logs.py

# Each measured number halved and doubled on a fixed set of logs and tasks, a minute of processor time each; NAMES takes some of them.
constants: release
	$(BIN)/python benches/constants.py docs/constants_measured.md $(NAMES)

# How often each rule of the diagnosis decides, on cases of the examination.
rule-counts: release
	$(BIN)/python benches/rules.py

# The site: the pages, the Python reference, and rustdoc beside them. Its links are checked without a network.
SITE := docs/_build/html
site: docs-rust docs-python
	rm -rf $(SITE)/rust
	cp -r target/doc $(SITE)/rust
	$(BIN)/python docs/check_site.py $(SITE)

docs-rust:
	RUSTDOCFLAGS="-D warnings" cargo doc $(GATE) $(CRATES) --no-deps

docs-python: build
	rm -rf $(SITE)
	$(BIN)/sphinx-build -q -W --keep-going docs $(SITE)

# Links to other sites, which need the network.
links: build
	$(BIN)/sphinx-build -q -b linkcheck docs docs/_build/links

# The release workflow and CITATION.cff against the schemas that the checker ships, and the workflow's rights and pins.
workflows: tools
	$(TOOLS)/check-jsonschema --builtin-schema vendor.github-workflows .github/workflows/*.yml
	$(TOOLS)/check-jsonschema --builtin-schema vendor.citation-file-format CITATION.cff
	$(TOOLS)/zizmor --offline --quiet --persona pedantic .github/workflows

# Wheel, source distribution and crate in dist/, each checked. The wheel is linked by zig against an old C library where one can be had,
# so that it runs on every Linux since 2018 (manylinux_2_28); elsewhere it is the platform's own.
LINUX := $(filter Linux,$(shell uname -s))
wheel: venv tools
	rm -rf dist
	PATH="$(abspath $(TOOLS)):$$PATH" $(BIN)/maturin build --release --locked --out dist \
		$(if $(LINUX),--zig --compatibility manylinux_2_28 --target $(shell uname -m)-unknown-linux-gnu)
	$(BIN)/maturin sdist --out dist
	cargo package --locked --allow-dirty -p interval-core
	cp target/package/interval-core-*.crate dist/
	$(BIN)/python -m tests.packages

# The wheel in an environment of its own, away from the tree: the tutorial's commands, in minutes. SOURCE=1 builds a wheel of the source there first.
try-wheel: venv
	$(BIN)/python -m tests.try_wheel $(if $(SOURCE),--source dist/*.tar.gz,dist/*.whl)

# The licences of the crates that a wheel holds.
licences: venv
	$(BIN)/python -m tests.licences

# Everything that left the gate, and fresh seeds; its last run becomes docs/nightly.md. PARTS names some of the parts.
nightly: build
	$(ONE_THREAD) $(BIN)/python -m tests.nightly $(PARTS)

bench: release
	cargo bench --locked
	$(BIN)/python benches/ratios.py

# The Rust benchmarks before and after a change, on one machine: `make bench-save`, the change, `make bench-compare`. Sweeps go up to 1e8
# partitions. BENCH takes one of interval, inverse and feasible, FILTER a part of the names, BASELINE another name; CRITERION_HOME names a
# folder that two trees share.
BASELINE ?= before
BENCHES = cargo bench --locked -p benches $(if $(BENCH),--bench $(BENCH)) -- $(FILTER)
bench-save:
	$(BENCHES) --save-baseline $(BASELINE)

bench-compare: venv
	$(BENCHES) --baseline-lenient $(BASELINE)
	$(BIN)/python benches/baseline.py $(BASELINE)

# Every peer that can be had, in one command: NumPy, numba, python-flint, codac, other interval packages, statistical fits, and inari at last,
# which is built from source. Peers that are missing are named and left out.
all-peers: inverse-peers fit-peers
	$(ONE_THREAD) $(BIN)/python benches/feasible_peers.py
	$(MAKE) --no-print-directory peers

# Logs and results in a local server of S3, whose packages stand apart from the environment.
stores: build
	$(BIN)/pip install --quiet --disable-pip-version-check --no-compile --no-deps --target $(VENV)/stores --requirement requirements/stores.txt
	PYTHONPATH=$(VENV)/stores $(BIN)/pytest -q tests/python/test_fleet_stores.py

# Memory and time of long logs: the table of docs/measurements.md.
ROWS ?= 1e6 1e7
long-logs: release
	PYTHONPATH=python $(BIN)/python benches/large_log.py $(ROWS)

# Throughput of ivsid fleet, and the same tables with workers killed: the table of docs/fleet.md.
LOGS ?= 1000
fleet-throughput: release
	PYTHONPATH=python $(BIN)/python benches/fleet_throughput.py out/fleet $(LOGS)

# The results of a fixed set of logs, in a folder; made in two trees, `make same-compare A=... B=...` names each difference.
SAME ?= out/same
same: release
	$(BIN)/python benches/same_results.py make $(DATA) $(SAME)

same-compare: venv
	$(BIN)/python benches/same_results.py compare $(A) $(B)

# Every command on every real set; the sets are not part of this repository.
DATA ?= ../shared/data
vessels: release
	$(BIN)/python benches/real_data.py $(DATA) out/vessels

# inari beside this crate, built for two targets; GMP and MPFR are built from source (m4 is needed, some minutes).
peers:
	cd benches/peers && cargo run --release --locked --target-dir target/haswell
	cd benches/peers && RUSTFLAGS=-Ctarget-cpu=native cargo run --release --locked --target-dir target/native

# The scalar part without the standard library has the bits that it has with it. `rustup target add` fetches the libraries of other targets;
# OLDEST is the oldest compiler of the crate, `stable` where it is not installed.
OLDEST ?= 1.85.0
TARGETS ?= wasm32-unknown-unknown thumbv7em-none-eabihf aarch64-unknown-linux-gnu x86_64-pc-windows-msvc
no-std:
	cargo test $(GATE) -p interval-core --no-default-features --features alloc --test without_std
	cargo test $(GATE) -p interval-core --no-default-features --features std --test without_std
	for target in $(TARGETS); do \
		cargo +$(OLDEST) check --locked -p interval-core --no-default-features --features alloc --target $$target --target-dir target/oldest || exit 1; \
		cargo +$(OLDEST) check --locked -p onboard --no-default-features --target $$target --target-dir target/oldest || exit 1; \
	done
	cargo +$(OLDEST) check --locked -p interval-core --no-default-features --features exact,parallel,serde --target-dir target/oldest

# The conformance vectors of IEEE 1788, which have to be there; IVSID_ITF1788 names another folder.
itf1788:
	IVSID_ITF1788=$(or $(IVSID_ITF1788),$(abspath $(DATA))/itf1788) cargo test --locked --test itf1788 -- --nocapture conformance

# Operands of every function that are compared with MPFR, and of every back end that are compared with the operators.
CASES ?= 1e8
differential: release
	IVSID_CASES=$(CASES) $(ONE_THREAD) $(BIN)/pytest -n auto tests/python/test_oracle.py
	IVSID_CASES=1e5 $(ONE_THREAD) $(BIN)/pytest -n auto tests/python/test_recommended.py
	IVSID_CASES=1e4 $(ONE_THREAD) $(BIN)/pytest -n auto tests/python/test_reverses.py
	IVSID_CASES=$(CASES) cargo test --locked --release --test slices

# Twins with a known truth, several vehicles, both kinds of rows and noise: is it inside? VERIFY=--verify proves each result, too.
TWINS ?= 500
twins: release
	$(BIN)/python tests/python/twins.py --twins $(TWINS) $(VERIFY)

# Inverses: verdicts on regularity by exact determinants, members of every family inside every enclosure; some minutes.
MATRICES ?= 1e5
exhaustive:
	IVSID_CASES=$(MATRICES) cargo test --locked --release --test regularity --test hull --test systems --test range --test inverse

# The sweep and the hulls beside peers that are installed; the figure of the sweep for the docs.
inverse-peers: release
	$(BIN)/python benches/inverse_peers.py

# Parameter intervals beside those of statistical fits, on twins of a known truth; statsmodels joins where it is installed.
fit-peers: release
	$(ONE_THREAD) $(BIN)/python benches/fit_peers.py --twins 100

throughput: release
	cargo bench --locked --bench inverse -- sweep
	$(BIN)/python benches/throughput.py docs/throughput.png

# Seconds of a diagnosis with figures and files, 600 s at 20 Hz, beside a fit by hand in the same run.
diagnosis-time: release
	$(ONE_THREAD) $(BIN)/python benches/diagnosis.py

# The back ends under valgrind, which has no AVX-512 and keeps no rounding mode: the test of changed modes stands aside.
memcheck:
	CARGO_TARGET_X86_64_UNKNOWN_LINUX_GNU_RUNNER="valgrind -q --error-exitcode=9" IVSID_CASES=200 \
		cargo test $(GATE) -p interval-core --test slices -- --skip a_changed_rounding_mode_is_refused

# The same and the tests beside it under AddressSanitizer, AVX-512 included; needs a nightly toolchain.
address:
	RUSTFLAGS=-Zsanitizer=address IVSID_CASES=2000 cargo +nightly test --locked --target x86_64-unknown-linux-gnu --target-dir target/address \
		-p interval-core --test slices --test rounding --test matrix --test sweep

# Seconds of mutated literals for the text parser.
SECONDS ?= 600
fuzz:
	IVSID_FUZZ_SECONDS=$(SECONDS) cargo test --locked --release --test fuzz_text -- --nocapture

# Mutated logs, vehicle files, scenarios and results: a value or one sentence. KINDS takes some of them, SEED repeats a run.
FILES ?= 1e6
fuzz-files: build
	$(ONE_THREAD) $(BIN)/python -m tests.fuzz_files $(if $(filter command line,$(origin CASES)),$(CASES),$(FILES)) $(SEED) $(KINDS)

# Named faults in a copy of the tree, each of which a test has to see; some of them by MUTANTS="'name' 'name'".
mutants: build
	$(ONE_THREAD) $(BIN)/python -m tests.mutants $(if $(MUTANTS),$(MUTANTS),--rust)

venv: $(VENV)/.ready

# Programs of a release, in an environment of their own: the gate needs none of them.
TOOLS := $(VENV)/tools/bin
tools: $(VENV)/.tools
$(VENV)/.tools: $(VENV)/.ready requirements/release.txt
	$(PYTHON) -m venv $(VENV)/tools
	$(TOOLS)/pip install --quiet --disable-pip-version-check --no-compile --requirement requirements/release.txt
	touch $@

# The compiled module of the gate serves whoever changes the code; that of a release replaces it, and serves the tests as well.
build: $(VENV)/.built

release: $(VENV)/.release

format: build
	cargo fmt --all
	$(BIN)/ruff format python tests examples benches docs/*.py
	$(BIN)/ruff check --fix python tests examples benches docs/*.py

# uv needs 5 processor seconds where pip needs 40. pip, which knows the mirrors and certificates of its own settings, takes over where
# uv cannot reach the registry.
UV := 0.13.9
$(VENV)/.ready: requirements/lock.txt
	$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "Python 3.11 or later is needed; set PYTHON=/path/to/it")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check --no-compile uv==$(UV) \
		&& $(BIN)/uv pip install --system-certs --quiet --python $(BIN)/python --no-cache --requirement requirements/lock.txt \
		|| $(BIN)/pip install --quiet --disable-pip-version-check --no-compile --requirement requirements/lock.txt
	touch $@

# What the commands import, compiled once and kept for whoever starts them.
COMPILED = $(BIN)/python -c 'import ivsid.cli, ivsid.workflow.diagnosis, ivsid.workflow.identification'

$(VENV)/.built: $(VENV)/.ready $(RUST_SOURCES) pyproject.toml
	VIRTUAL_ENV=$(abspath $(VENV)) $(BIN)/maturin develop $(GATE) --quiet
	$(COMPILED)
	rm -f $(VENV)/.release
	touch $@

$(VENV)/.release: $(VENV)/.ready $(RUST_SOURCES) pyproject.toml
	VIRTUAL_ENV=$(abspath $(VENV)) $(BIN)/maturin develop --release --locked --quiet
	$(COMPILED)
	touch $(VENV)/.built $@

clean:
	rm -rf $(VENV) target out dist docs/_build python/ivsid/*.so

# Drawn cases of the diagnosis, sealed, and their score, which becomes a page of the docs; an hour and a half for 1000 on two cores.
SEED ?= $(shell date +%s)
EXAM ?= 1000
exam: release
	$(BIN)/python -m tests.exam.run $(SEED) $(EXAM) out=out/exam.json table=docs/examination.md

# Counts behind the probabilities of findings, from the rows of an examination.
reliability: venv
	$(BIN)/python -m tests.exam.reliability out/exam.json
