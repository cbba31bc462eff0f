"""A boat with numbers to export, and its variants."""

from ivsid.vehicle import parse_vehicle

TRUTH = {
    "mass.surge": 58.0,
    "mass.sway": 75.0,
    "inertia.yaw": 9.0,
    "drag.surge.quadratic": 28.0,
    "drag.sway.quadratic": 150.0,
}
DAMPED = {
    "drag.surge.linear": 4.0,
    "drag.sway.linear": 8.0,
    "drag.yaw.linear": 1.5,
    "drag.yaw.quadratic": 2.5,
}
FURTHER = {
    "drag.surge.astern": 10.0,
    "drag.surge.sideslip": 30.0,
    "drag.sway.yaw_rate": -4.0,
    "drag.lift.sway": 12.0,
    "drag.lift.yaw": -3.0,
    "added_mass.munk": 6.0,
    "coupling.cg_x": 1.5,
    "coupling.cg_y": -0.7,
}
CUBIC = {"drag.surge.cubic": 5.0, "drag.sway.cubic": 70.0, "drag.yaw.cubic": 4.0}
BEYOND = {"friction.coulomb": 1.2, "current.steady.north": 0.3, "current.steady.east": -0.2}
TABLE = "table = { demand = [-100, -60, -30, 0, 30, 60, 100], thrust = [-30.0, -14.0, -5.0, 0.0, 6.0, 18.0, 40.0] }"
QUADRATIC = "quadratic = { forward = 0.011 }\ndemand_range = [-110, 110]"
WHOLE = {**TRUTH, **DAMPED, **FURTHER, **CUBIC, **BEYOND, "wind.steady.north": 1.5, "wind.steady.east": -0.8}


def boat(numbers, curve=QUADRATIC, *, extra="", terms="", hull="length = 1.2", head=""):
    """A boat with asymmetric thrusters and a centre of gravity off the origin."""
    text = f'name = "Small boat"\n[hull]\nmass = 50\n{hull}\ncentre_of_gravity = [0.05, -0.02]\n'
    for name, place, azimuth in (("port", "[-0.35, -0.30]", 0.1), ("starboard", "[-0.40, 0.25]", -0.2)):
        text += f'[[thrusters]]\nname = "{name}"\nposition = {place}\nazimuth = {azimuth}\n{curve}\n{extra}\n'
    text += f"{head}\n[model]\n{terms}\n[model.fitted]\n"
    text += "".join(f'"{k}" = {{ value = {v}, lower = {v - 0.25}, upper = {v + 0.5} }}\n' for k, v in numbers.items())
    return parse_vehicle(text, "boat.toml")
