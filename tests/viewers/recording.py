"""A run as a recording of Rerun: every frame and measure, a view from above, a plot for each unit."""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import coronet

ROOT = Path(__file__).resolve().parents[2]
RINGS = {
    "box.symmetry": "axis",
    "box.x": "wall",
    "box.y": "wall",
    "effects.wetting.angle": "90 deg",
}


def main():
    rerun = Path(sys.executable).with_name("rerun")
    for name, settings in [("whole", {}), ("rings", RINGS)]:
        with tempfile.TemporaryDirectory() as folder:
            scene = ROOT / "scenes/tiny.toml"
            run = coronet.run(scene, settings, artifacts=folder, name=name)
            path = Path(folder, "run.rrd")
            command = [sys.executable, "-m", "coronet.rerun", str(run.folder), "--save", str(path)]
            home = {**os.environ, "HOME": folder}
            subprocess.run(command, check=True, env=home)
            subprocess.run([rerun, "rrd", "verify", path], check=True, env=home)
            command = [rerun, "rrd", "print", "-v", path]
            text = subprocess.run(command, check=True, env=home, capture_output=True, text=True).stdout
            frames = len(run.times)
            # Since 0.41 a component is printed with the path of its entity.
            upright = r"/liquid - data columns: \[(/liquid@)?ViewCoordinates:xyz\]"
            assert re.search(upright, text), f"no axes of the liquid in:\n{text[:6000]}"
            for wanted in [
                "/liquid/drop",
                "/liquid/pool",
                f"with {frames} rows",
                "/measures/crater_depth_m",
                "/measures/kinetic_energy_J",
                "BlueprintActivationCommand",
                "ViewBlueprint",
            ]:
                assert wanted in text, f"{wanted!r} is not in:\n{text[:6000]}"
            print(f"recording of {name}: good, {frames} frames")


main()
