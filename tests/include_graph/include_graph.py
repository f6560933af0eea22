"""Reads every #include line of the project and holds it to the arrows of the architecture.

    include_graph.py ROOT     prints one line per wrong include; exit code 1 when there is one

ROWS says for each folder (the longest that fits a file counts) what of the project it may include besides itself,
HOMES where a heavy dependency may be seen; "export/." means the files that lie directly in export. tests and
examples are free; a folder without a row is an error, so a new folder has to say where it stands.
"""

import pathlib
import re
import sys

FLIGHT = "ingest/flight"
MOTION = "ingest/motion"
DRAG = "ingest/motion/drag.h"
REFERENCE = "ingest/reference"
READERS = [f"ingest/{name}" for name in ("mcap", "ulog", "dataflash", "mavlink", "paparazzi", "csv")]
ESTIMATOR = ["estimator/filter", "estimator/smoother"]
CALIBRATION = "estimator/calibration"
SHARED_BY_PRODUCTS = "export/."
PRODUCTS = [f"export/{name}" for name in ("geoid", "magnetic", "station", "cf_netcdf", "uasdc", "bufr", "mcap", "csv", "geojson", "kml",
                                         "met_point", "report", "archive")]
BEHIND_PRODUCTS = [FLIGHT, MOTION, REFERENCE, *ESTIMATOR, "profiles", SHARED_BY_PRODUCTS]

ROWS = {
    FLIGHT: [],
    **{reader: [FLIGHT] for reader in READERS},
    "ingest/open": [FLIGHT, *READERS],
    MOTION: [FLIGHT],
    DRAG: [],
    REFERENCE: [FLIGHT],
    "estimator/filter": [DRAG],
    "estimator/smoother": [FLIGHT, MOTION, "estimator/filter"],
    CALIBRATION: [FLIGHT, MOTION, *ESTIMATOR],
    "profiles": [FLIGHT, MOTION, REFERENCE, *ESTIMATOR],
    SHARED_BY_PRODUCTS: [FLIGHT],
    # A product may be made of others (a report of a picture), but none knows how the numbers were made.
    **{product: [*BEHIND_PRODUCTS, *PRODUCTS] for product in PRODUCTS},
    "export/geoid": [FLIGHT],
    "export/magnetic": [FLIGHT],
    "export/mcap": [*BEHIND_PRODUCTS, *PRODUCTS, "ingest/mcap"],
    # A calibration is a result that pictures and answers show, as they show a profile.
    "export/report": [*BEHIND_PRODUCTS, *PRODUCTS, "estimator/calibration"],
    # It judges files of any kind, so it opens and reads them.
    "export/validate": [*BEHIND_PRODUCTS, *PRODUCTS, "ingest/mcap", "ingest/open"],
    "export/pipeline": ["ingest", "estimator", "profiles", "export"],
    "cli": ["ingest", "estimator", "profiles", "export"],
}
# These fly on board too: the C++ library and Eigen, nothing else.
ON_BOARD = [DRAG, "estimator/filter"]
FREE = ["tests", "examples"]
TOP = ["ingest", "estimator", "profiles", "export", "cli", "tests", "examples"]

HOMES = [  # (name, its headers, the folders where it may be included)
    ("SUNDIALS", r"(sundials|cvodes?|arkode|idas?|kinsol|nvector|sunmatrix|sunlinsol|sunnonlinsol)/", [MOTION]),
    ("Ceres", r"(ceres|glog)/", ["estimator/smoother", CALIBRATION]),
    ("netCDF", r"netcdf", ["export/cf_netcdf", REFERENCE]),
    ("SQLite", r"sqlite3", ["export/archive"]),
    ("ecCodes", r"eccodes", ["export/bufr", REFERENCE]),
    ("UDUNITS", r"udunits2", ["export/validate"]),
    ("GeographicLib", r"GeographicLib/", ["ingest", "export/geoid", "export/magnetic"]),
    ("protobuf", r"google/protobuf/", ["ingest/mcap", "export/mcap"]),
    ("toml++", r"toml\+\+|toml\.hpp", [f for f in [*ROWS, *TOP] if f != FLIGHT and f not in ("ingest", *ON_BOARD)]),
    ("CLI11", r"CLI/", ["cli"]),
]

SOURCE_ENDINGS = {".h", ".hpp", ".cc", ".cpp", ".inc"}
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*(?:"([^"]+)"|<([^>]+)>)', re.MULTILINE)
BLOCK_COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)


def within(path, folder):
    if folder.endswith("/."):
        return path.rpartition("/")[0] == folder[:-2]
    return path == folder or path.startswith(folder + "/")


def row_of(path):
    fitting = [folder for folder in ROWS if within(path, folder)]
    return max(fitting, key=len) if fitting else None


def includes(text):
    """(line, header, quoted) of every include, those behind an #if as well; comments are blanked, lines kept."""
    text = BLOCK_COMMENT.sub(lambda comment: re.sub(r"[^\n]", " ", comment.group(0)), text)
    for found in INCLUDE.finditer(text):
        yield text.count("\n", 0, found.start()) + 1, found.group(1) or found.group(2), found.group(1) is not None


def wrong_include(root, path, header, quoted):
    """What is wrong with this include, or None."""
    if header.startswith((".", "/")) or "/../" in header or "/./" in header:
        return "is not written from the project's root"
    row = row_of(path)
    target_is_ours = header.split("/")[0] in TOP and "/" in header
    if quoted and not target_is_ours and (root / path).parent.joinpath(header).exists():
        return "is not written from the project's root"
    if target_is_ours:
        if any(within(header, folder) for folder in [row, *ROWS[row]]) and not hides_behind(row, header):
            return None
        return f"is a wrong arrow: {row} may include {', '.join([*ROWS[row], 'itself'])}"
    for name, headers, folders in HOMES:
        if re.match(headers, header) and not any(row == folder or within(path, folder) for folder in folders):
            return f"is {name}, whose home is {', '.join(folders) if len(folders) < 4 else 'elsewhere'}"
    if row in ON_BOARD and ("." in header or "/" in header) and not header.startswith("Eigen/"):
        return f"is neither the C++ library nor Eigen: {row} flies on board"
    return None


def hides_behind(row, header):
    """drag.h lives in ingest/motion, which may include it; nothing else of that folder is drag.h's own."""
    return row == DRAG and header != DRAG


def check(root):
    """(number of files read, list of complaints)."""
    root = pathlib.Path(root)
    complaints, files = [], 0
    for top in TOP:
        for file in sorted((root / top).rglob("*")):
            if file.suffix not in SOURCE_ENDINGS or not file.is_file():
                continue
            files += 1
            path = file.relative_to(root).as_posix()
            if top in FREE:
                continue
            if row_of(path) is None:
                complaints.append(f"{path}: its folder has no row in tests/include_graph/include_graph.py")
                continue
            for line, header, quoted in includes(file.read_text(encoding="utf-8")):
                wrong = wrong_include(root, path, header, quoted)
                if wrong:
                    complaints.append(f"{path}:{line}: {header} {wrong}")
    return files, complaints


def main():
    files, complaints = check(sys.argv[1])
    print("\n".join(complaints + [f"{files} files, {len(complaints)} wrong includes"]))
    return 1 if complaints or not files else 0


if __name__ == "__main__":
    sys.exit(main())
