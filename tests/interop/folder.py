"""What becomes of every mesh file in a folder.

python3 tests/interop/folder.py fetch FOLDER                      # fills it with the sample files of other programs
python3 tests/interop/folder.py run target/release/planish FOLDER [--each] [--preset catmull-clark --levels 1 ...]

`fetch` downloads the Debian packages assimp-testmodels and libcgal-demo and the wheels of pyvista and pymeshlab, and
unpacks them; nothing of it is part of the build. `run` converts each file to GLB and counts what converts and what is
refused with which sentence, numbers and names left out; `--each` prints a line a file. What follows is handed to planish.
"""

import collections
import re
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

DEBIAN = ["assimp-testmodels", "libcgal-demo"]
WHEELS = ["pyvista", "pymeshlab"]
KINDS = {".obj", ".ply", ".stl", ".off", ".gltf", ".glb"}
TIMEOUT_S = 120


def fetch(folder):
    folder.mkdir(parents=True, exist_ok=True)
    subprocess.run(["apt-get", "download", *DEBIAN], cwd=folder, check=True)
    subprocess.run([sys.executable, "-m", "pip", "download", "--no-deps", *WHEELS], cwd=folder, check=True)
    for package in folder.glob("*.deb"):
        subprocess.run(["dpkg-deb", "-x", package, folder / package.name.split("_")[0]], check=True)
    for data in folder.glob("libcgal-demo/usr/share/doc/**/data.tar.gz"):
        tarfile.open(data).extractall(folder / "libcgal-demo", filter="data")
    for wheel in folder.glob("*.whl"):
        zipfile.ZipFile(wheel).extractall(folder / wheel.name.split("-")[0])


def outcome(planish, path, options):
    """None where the file converts, else what is said against it; then the warnings."""
    command = [planish, "render", path, "-o", "-", "--format", "glb", *options]
    try:
        done = subprocess.run(command, capture_output=True, timeout=TIMEOUT_S, check=False)
    except subprocess.TimeoutExpired:
        return f"no answer within {TIMEOUT_S} s", []
    said = done.stderr.decode(errors="replace").strip().splitlines()
    if done.returncode == 0:
        return None, [line for line in said if line.strip()]
    if done.returncode not in (1, 2, 3, 4, 5):
        return f"exit code {done.returncode}: {' '.join(said)}", []
    return " ".join(line.strip() for line in said[:2] if "cannot be done" not in line) or "nothing is said", []


def kind(sentence):
    """The sentence without what is different from file to file."""
    plain = re.sub(r'"[^"]*"(\.\.\.)?', '"..."', sentence)
    return re.sub(r"\d[\d.e+-]*(, \d+)*", "N", plain)[:150]


def run(planish, folder, each, options):
    files = sorted(path for path in folder.rglob("*") if path.suffix.lower() in KINDS and path.is_file())
    table = collections.Counter()
    kinds = collections.defaultdict(list)
    for path in files:
        refusal, warnings = outcome(planish, path, options)
        extension = path.suffix.lower()[1:]
        table[extension, refusal is None] += 1
        name = path.relative_to(folder)
        if refusal:
            kinds[kind(refusal)].append(name)
        if each:
            print(f"{'refused' if refusal else 'converts'}\t{name}\t{refusal or ' | '.join(warnings)}")
    print("| format | files | convert | refused |\n|---|---|---|---|")
    for extension in sorted({extension for extension, _ in table}):
        good, bad = table[extension, True], table[extension, False]
        print(f"| {extension} | {good + bad} | {good} | {bad} |")
    good = sum(n for (_, converts), n in table.items() if converts)
    print(f"| all | {len(files)} | {good} | {len(files) - good} |\n")
    print("| files | refused with | for example |\n|---|---|---|")
    for sentence, names in sorted(kinds.items(), key=lambda entry: (-len(entry[1]), entry[0])):
        print(f"| {len(names)} | {sentence} | {names[0].name} |")


def main():
    match sys.argv[1:]:
        case ["fetch", folder]:
            fetch(Path(folder))
        case ["run", planish, folder, *rest]:
            options = [option for option in rest if option != "--each"]
            run(Path(planish).resolve(), Path(folder).resolve(), "--each" in rest, options)
        case _:
            sys.exit(__doc__)


main()
