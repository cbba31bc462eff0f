"""Every public operation under every changed mode of the processor; runs in a process of its own: python modes.py.

A mode is a value of MXCSR, the control register of SSE (Intel 64 manual, volume 1, section 10.2.3). For each operation and mode the outcome is ``refused`` (a
sentence), ``same`` (the bits of the default mode), or what differs. Operands are chosen so that a wrong mode would show: a tenth, a third, subnormal numbers.
"""

import ctypes
import json
import mmap
import sys
import threading
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np

DEFAULT = 0x1F80
MODES = {
    "down": DEFAULT | 0x2000,
    "up": DEFAULT | 0x4000,
    "to zero": DEFAULT | 0x6000,
    "flush to zero": DEFAULT | 0x8000,
    "denormals are zero": DEFAULT | 0x0040,
    "both": DEFAULT | 0x8040,
}
# ldmxcsr [rdi]; ret
_PAGE = mmap.mmap(-1, 4096, prot=mmap.PROT_READ | mmap.PROT_WRITE | mmap.PROT_EXEC)
_PAGE.write(bytes([0x0F, 0xAE, 0x17, 0xC3]))
_LOAD = ctypes.CFUNCTYPE(None, ctypes.POINTER(ctypes.c_uint32))(ctypes.addressof(ctypes.c_char.from_buffer(_PAGE)))
_WORDS = {value: ctypes.c_uint32(value) for value in (DEFAULT, *MODES.values())}


WHOLE = (
    "diagnose",
    "identify",
    "validate",
    "verify",
    "setup_findings",
    "read_log",
    "read_vehicle",
    "parse_vehicle",
    "parse_scenario",
    "simulate",
)


def set_mode(value):
    """Sets the mode of this thread."""
    _LOAD(_WORDS[value])


def bits(x):
    """A value as something that is equal exactly where its bits are."""
    import ivsid

    if isinstance(x, ivsid.Interval):
        return [bits(x.lower), bits(x.upper)]
    if isinstance(x, ivsid.IntervalArray):
        return [x.lower.tobytes().hex(), x.upper.tobytes().hex(), list(x.shape)]
    if isinstance(x, np.ndarray):
        return [x.tobytes().hex() if x.dtype != object else [bits(y) for y in x.ravel()], list(x.shape)]
    if isinstance(x, float):
        return np.float64(x).tobytes().hex()
    if isinstance(x, list | tuple):
        return [bits(y) for y in x]
    return [bits(y) for y in x] if isinstance(x, Iterator) else repr(x)


def operations():
    """Name and call of every public operation, by enumeration: what is new and has no call here is named, too."""
    import ivsid
    from ivsid.intervals import protocol

    tiny, third = 5e-324, 1.0 / 3.0
    x, y = ivsid.Interval(0.1, third), ivsid.Interval(-tiny, 3 * tiny)
    a = ivsid.IntervalArray([0.1, tiny, -third], [third, 1e-310, 3.0])
    b = ivsid.IntervalArray([tiny, 0.3, -tiny], [2.0, 0.7, 0.0])
    m = ivsid.IntervalArray(np.array([[2.0, 0.1], [third, 3.0]]), np.array([[2.1, 0.2], [0.4, 3.1]]))
    right = ivsid.IntervalArray([0.1, tiny], [0.3, 1.0])
    tall = ivsid.IntervalArray(np.array([[1.0, 0.1], [third, 1.0], [0.7, tiny]]))
    level = ivsid.IntervalArray([0.9, 0.8, 0.6], [1.4, 1.7, 0.9])
    calls = {}
    arguments = {
        "contains": (0.0,), "subset": (y,), "interior": (y,), "disjoint": (y,), "hull": (y,), "intersection": (y,), "arctan2": (y,), "arctan2pi": (y,), "hypot": (y,), "compoundm1": (y,), "rootn": (3,), "fma": (x, y),
        "powi_rev": (3,), "mul_rev": (y,), "mul_rev_to_pair": (y,), "pow_rev_base": (y,), "pow_rev_exponent": (y,), "arctan2_rev_y": (y,), "arctan2_rev_x": (y,),
        "__contains__": (0.0,), "__pow__": (3,), "__rpow__": (2.0,), "__format__": ("",), "__reduce_ex__": (2,),
    }  # fmt: skip
    # What a class has by being one.
    plain = {
        *(
            "__class__",
            "__delattr__",
            "__dir__",
            "__doc__",
            "__getattribute__",
            "__init__",
            "__init_subclass__",
            "__module__",
            "__setattr__",
        ),
        *(
            "__sizeof__",
            "__subclasshook__",
            "__array_ufunc__",
            "__array_function__",
            "__slots__",
            "__hash__",
            "__setstate__",
            "__new__",
        ),
    }
    binary = ("add", "radd", "sub", "rsub", "mul", "rmul", "truediv", "rtruediv", "eq", "ne", "lt", "le", "gt", "ge")
    for name in dir(ivsid.Interval):
        if name in plain or (name.startswith("_") and not name.startswith("__")):
            continue
        for label, one in (("x", x), ("y", y)):
            given = (y,) if name.strip("_") in binary else arguments.get(name, ())
            if isinstance(getattr(ivsid.Interval, name), property) or not callable(getattr(one, name)):
                calls[f"Interval.{name} of {label}"] = lambda one=one, name=name: getattr(one, name)
            elif name in ("empty_set", "entire"):
                calls[f"Interval.{name}"] = getattr(ivsid.Interval, name)
            else:
                calls[f"Interval.{name} of {label}"] = lambda one=one, name=name, given=given: getattr(one, name)(
                    *given
                )
    for given in ((0.1, third), (tiny,), (0.0, tiny), ("0.1",), ("[0.1, 1/3]",), (1, 2)):
        calls[f"Interval{given}"] = lambda given=given: ivsid.Interval(*given)
    arguments = {
        "contains": (np.zeros(3),), "subset": (b,), "hull": (b,), "intersection": (b,), "arctan2pi": (b,), "hypot": (b,), "compoundm1": (b,), "rootn": (3,), "around": ([0.1, tiny], [third, tiny]), "concatenate": ([a, b],),
        "stack": ([a, b],), "reshape": (3, 1), "__getitem__": (1,), "__pow__": (3,), "__rpow__": (2.0,), "__matmul__": (b,), "__rmatmul__": (b,),
        "__format__": ("",), "__reduce_ex__": (2,), "powi_rev": (3,), "mul_rev": (b,), "mul_rev_to_pair": (b,), "pow_rev_base": (b,), "pow_rev_exponent": (b,), "arctan2_rev_y": (b,),
        "arctan2_rev_x": (b,),
    }  # fmt: skip
    for name in dir(ivsid.IntervalArray):
        if name in plain or (name.startswith("_") and not name.startswith("__")):
            continue
        given = (b,) if name.strip("_") in binary else arguments.get(name, ())
        one = a
        if callable(getattr(one, name)):
            calls[f"IntervalArray.{name}"] = lambda one=one, name=name, given=given: getattr(one, name)(*given)
        else:
            calls[f"IntervalArray.{name}"] = lambda one=one, name=name: getattr(one, name)
    calls["IntervalArray(...)"] = lambda: ivsid.IntervalArray([tiny, 0.1], [1e-310, third])
    calls["IntervalArray.__ne__"] = lambda: a != b
    calls["IntervalArray.sum(0)"] = lambda: m.sum(0)
    calls["iteration"] = lambda: list(a)
    for table in (value for value in vars(protocol).values() if isinstance(value, dict)):
        for function in table:
            if isinstance(function, np.ufunc):
                given = (a, b, a)[: function.nin]
                calls[f"np.{function.__name__}"] = lambda f=function, g=given: f(*g)
            elif callable(function) and function.__module__ == "numpy":
                calls[f"np.{function.__name__}"] = lambda f=function: called(f, a, b)
    for name in dir(ivsid.linalg):
        method = getattr(ivsid.linalg, name)
        if (
            not callable(method)
            or getattr(method, "__module__", "") != "ivsid.linear.linalg"
            or name.startswith("_")
            or isinstance(method, type)
        ):
            continue
        given = {"solve": (m, right), "norm": (m,)}.get(name.split("_")[0], (m,))
        if name.endswith("_batch"):
            given = tuple(ivsid.IntervalArray.stack([g, g]) for g in given)
        if name in ("bounds_of", "check_method", "make_result"):
            continue
        if name == "partition_count":
            given = (None, "exact")
        calls[f"linalg.{name}"] = lambda f=method, g=given: f(*g)
    for name in ("feasible_set", "gram", "least_squares", "normal_equations"):
        given = (tall,) if name == "gram" else (tall, level)
        calls[f"regression.{name}"] = lambda n=name, g=given: getattr(ivsid.regression, n)(*g)
    return calls


def called(function, a, b):
    """A function of NumPy with arguments that fit its name."""
    name = function.__name__
    more = {
        "concatenate": ([a, b],), "stack": ([a, b],), "vstack": ([a, b],), "hstack": ([a, b],), "dot": (a, b), "where": (np.array([True, False, True]), a, b),
        "reshape": (a, (3, 1)), "broadcast_to": (a, (2, 3)), "moveaxis": (a.reshape(1, 3), 0, 1), "swapaxes": (a.reshape(1, 3), 0, 1),
        "expand_dims": (a, 0), "roll": (a, 1), "repeat": (a, 2), "tile": (a, 2), "take": (a, [0, 2]), "diagonal": (a.reshape(1, 3),),
    }  # fmt: skip
    return function(*more.get(name, (a,)))


def files(folder):
    """The public functions that read, fit, check and write."""
    import ivsid
    from conftest import embedded
    from ivsid.programme.scenario import parse_scenario
    from ivsid.simulation import simulate
    from ivsid.vehicle import parse_vehicle
    from ivsid.workflow.log_files import csv

    text = embedded("swan.toml")
    plan = embedded("swan_train.toml").replace("duration = 300.0", "duration = 8.0", 1)
    vehicle, scenario = parse_vehicle(text, "swan.toml"), parse_scenario(plan, "plan.toml")
    made = simulate(vehicle, scenario, 1)
    (folder / "swan.toml").write_text(text)
    (folder / "run.csv").write_text(csv(made.t, made.columns))
    log = ivsid.read_log(folder / "run.csv", vehicle.log)
    fit = ivsid.identify(vehicle, log, examine=False)
    fit.save(folder / "fit")
    return {
        "read_vehicle": lambda: ivsid.read_vehicle(folder / "swan.toml"),
        "read_log": lambda: ivsid.read_log(folder / "run.csv", vehicle.log),
        "parse_vehicle": lambda: parse_vehicle(text, "swan.toml"),
        "parse_scenario": lambda: parse_scenario(plan, "plan.toml"),
        "identify": lambda: ivsid.identify(vehicle, log, examine=False),
        "validate": lambda: ivsid.validate(fit, log),
        "verify": lambda: ivsid.verify(folder / "fit", log),
        "setup_findings": lambda: ivsid.setup_findings(vehicle, log),
        "export": lambda: ivsid.export(fit, "mss").text,
        "diagnose": lambda: ivsid.diagnose(vehicle, log, log),
        "simulate": lambda: simulate(vehicle, scenario, 1).columns["u"],
        "Identification.save": lambda: fit.save(folder / "again"),
    }


def outcome(call, mode, plain):
    """The outcome of a call in a mode."""
    import ivsid

    set_mode(mode)
    try:
        try:
            found = call()
        finally:
            set_mode(DEFAULT)
    except ivsid.IvsidError as refusal:
        return "refused" if "round to nearest" in str(refusal) else f"another sentence: {refusal}"
    except BaseException as error:
        # An operation that is not defined is that in every mode.
        return "same" if plain == type(error).__name__ else f"{type(error).__name__}: {error}"
    return "same" if plain is not None and bits(found) == plain else "differs"


def main():
    """Prints the outcomes as JSON."""
    warnings.simplefilter("ignore")
    folder = Path(sys.argv[1])
    found = {}
    for group in (operations(), files(folder)):
        for name, call in group.items():
            if name in WHOLE:
                # Whole results are not compared: they are refused at once.
                found[name] = {mode: outcome(call, value, None) for mode, value in MODES.items()}
                continue
            try:
                plain = bits(call())
            except TypeError:
                plain = "TypeError"
            except Exception as error:
                found[name] = {"default": f"{type(error).__name__}: {error}"}
                continue
            found[name] = {mode: outcome(call, value, plain) for mode, value in MODES.items()}
    # A thread with a mode of its own, and one without beside it.
    import ivsid

    a = ivsid.IntervalArray(np.full(10, 0.1))
    said = {}

    def inside(mode):
        said[mode] = outcome(lambda: a + a, mode, bits(a + a))

    threads = [threading.Thread(target=inside, args=(mode,)) for mode in (DEFAULT, *MODES.values())]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    found["threads"] = {"default": said[DEFAULT], **{name: said[value] for name, value in MODES.items()}}
    # A mode that is changed between the pieces of one call.
    from ivsid.intervals import pieces

    def changing(part):
        if part.start:
            set_mode(MODES["up"])
        try:
            return ivsid.IntervalArray(np.full(part.stop - part.start, 0.1)) + 0.2
        finally:
            set_mode(DEFAULT)

    found["pieces"] = {"up": outcome(lambda: pieces.interval_pieces(3 * pieces.PIECE, changing), DEFAULT, None)}
    sys.stdout.write(json.dumps(found))


if __name__ == "__main__":
    main()
