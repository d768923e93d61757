#!/usr/bin/env python3
"""How the lift of the skin and the pressure of the fat depend on the stiffness of the skin.

The modulus of skin is known within a factor of five (90 to 500 kPa): a plan deserves to be looked
at over that range. Writes a picture and a CSV.

    sweep_stiffness.py PLAN.json --out sweep [--moduli-kpa 90 150 250 500]
        [--server HOST:PORT | --spawn]
"""

import argparse
import contextlib
import csv
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import lipofill

COLUMNS = ["youngs_modulus_kpa", "skin_max_displacement_mm", "skin_volume_change_ml", "max_pressure_pa", "state"]


def settled_shape(connection, plan, patient, modulus_kpa):
    """The summary of the plan's settled shape with this modulus for its outermost layer."""
    varied = plan.copy().settle()
    varied.model.layers[0].youngs_modulus_kpa = modulus_kpa
    with connection.run(varied, patient=patient) as run:
        return run.wait()


def sweep(connection, plan, moduli_kpa):
    """A row for each modulus. One patient for all: the scan is sent once."""
    patient = connection.patients.create().name
    rows = []
    try:
        for modulus_kpa in moduli_kpa:
            result = settled_shape(connection, plan, patient, modulus_kpa)
            figures = [getattr(result.summary, name) for name in COLUMNS[1:-1]]
            rows.append([modulus_kpa, *figures, result.State.Name(result.state)])
            print("{:8.1f} kPa: lift {:.2f} mm, {:.2f} mL, pressure {:.0f} Pa, {}".format(*rows[-1]), flush=True)
    finally:
        connection.patients.delete(patient, force=True)
    return rows


def plot(rows, layer, title, png):
    """Lift and pressure over the modulus, a panel each."""
    figure, (lift, pressure) = plt.subplots(1, 2, figsize=(9, 3.6), constrained_layout=True)
    moduli = [row[0] for row in rows]
    lift.plot(moduli, [row[1] for row in rows], "o-", color="#b2182b")
    lift.set_ylabel("largest displacement of the skin [mm]")
    pressure.plot(moduli, [row[3] / 1e3 for row in rows], "o-", color="#2166ac")
    pressure.axhline(1.2, color="0.5", linestyle="--", linewidth=1)
    pressure.annotate("9 mmHg", (moduli[0], 1.2), textcoords="offset points", xytext=(0, 4), color="0.4")
    pressure.set_ylabel("largest settled pressure [kPa]")
    for axes in (lift, pressure):
        axes.set_xlabel(f"Young's modulus of the {layer} [kPa]")
        axes.set_ylim(bottom=0)
        axes.grid(alpha=0.3)
    figure.suptitle(f"{title}. Research and planning aid, not a medical device.", fontsize=10)
    figure.savefig(png, dpi=150)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("plan")
    parser.add_argument(
        "--out", type=pathlib.Path, default=pathlib.Path("sweep"), help="folder for sweep.png and sweep.csv"
    )
    parser.add_argument("--moduli-kpa", type=float, nargs="+", default=[90, 120, 180, 260, 370, 500])
    parser.add_argument("--server", help="default: LIPOFILL_SERVER, else 127.0.0.1:50061")
    parser.add_argument("--spawn", action="store_true", help="a private daemon, for this run only")
    arguments = parser.parse_args()
    plan = lipofill.Plan.load(arguments.plan)
    arguments.out.mkdir(parents=True, exist_ok=True)
    with contextlib.ExitStack() as stack:
        server = stack.enter_context(lipofill.Daemon()).server if arguments.spawn else arguments.server
        connection = stack.enter_context(lipofill.Connection(server))
        rows = sweep(connection, plan, arguments.moduli_kpa)
    with open(arguments.out / "sweep.csv", "w", newline="") as stream:
        csv.writer(stream).writerows([COLUMNS, *rows])
    plot(rows, plan.model.layers[0].name, plan.message.name, arguments.out / "sweep.png")
    print(f"drew {arguments.out / 'sweep.png'}")


if __name__ == "__main__":
    main()
