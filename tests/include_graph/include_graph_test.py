"""The checker bites: each wrong arrow, put into a made-up tree, is reported with its file and line."""

import pathlib
import tempfile
import unittest

import include_graph

WRONG = {  # file: a header that it must not include
    "ingest/flight/a.h": ["ingest/mcap/mcap.h", "ingest/motion/drag.h", "toml++/toml.h", "estimator/filter/filter.h"],
    "ingest/ulog/a.cc": ["ingest/mcap/mcap.h", "ingest/motion/vehicle.h", "ingest/open/open.h"],
    "ingest/mcap/a.cc": ["profiles/profile.h"],
    "ingest/open/a.cc": ["ingest/motion/vehicle.h", "estimator/smoother/smoother.h"],
    "ingest/motion/a.h": ["ingest/csv/csv.h", "estimator/filter/filter.h", "ceres/ceres.h", "cli/main.h"],
    "ingest/motion/drag.h": ["ingest/flight/flight.h", "ingest/motion/vehicle.h", "fmt/format.h", "toml++/toml.h"],
    "ingest/reference/a.cc": ["ingest/motion/vehicle.h", "ingest/open/open.h"],
    "estimator/filter/a.h": ["ingest/flight/flight.h", "ingest/motion/vehicle.h", "fmt/format.h", "tl/expected.hpp",
                             "ceres/ceres.h", "estimator/smoother/smoother.h", "toml++/toml.h"],
    "estimator/smoother/a.cc": ["ingest/open/open.h", "ingest/csv/csv.h", "profiles/profile.h", "cvodes/cvodes.h"],
    "estimator/calibration/a.cc": ["ingest/mcap/mcap.h", "export/pipeline/pipeline.h"],
    "profiles/a.cc": ["ingest/open/open.h", "ingest/ulog/ulog.h", "export/csv/csv.h", "netcdf.h"],
    "export/a.cc": ["export/csv/csv.h", "profiles/profile.h"],
    "export/csv/a.cc": ["ingest/open/open.h", "estimator/calibration/calibration.h", "export/pipeline/pipeline.h",
                        "ingest/mcap/mcap.h", "CLI/CLI.hpp"],
    "export/report/a.cc": ["cli/main.h", "netcdf.h", "eccodes.h"],
    "export/pipeline/a.cc": ["cli/main.h", "tests/support/data.h"],
    "cli/a.cc": ["tests/support/data.h", "sundials/sundials_types.h", "../ingest/flight/flight.h", "beside.h"],
}
RIGHT = {
    "ingest/flight/a.cc": ["ingest/flight/a.h", "vector", "Eigen/Core", "GeographicLib/LocalCartesian.hpp"],
    "ingest/ulog/a.cc": ["ingest/ulog/a.h", "ingest/flight/flight.h", "zlib.h"],
    "ingest/open/a.cc": ["ingest/ulog/a.h", "ingest/csv/csv.h", "toml++/toml.h"],
    "ingest/motion/a.cc": ["ingest/motion/drag.h", "ingest/flight/flight.h", "cvodes/cvodes.h", "toml++/toml.h"],
    "ingest/motion/drag.h": ["Eigen/Core", "cmath"],
    "estimator/filter/a.h": ["ingest/motion/drag.h", "estimator/filter/b.h", "array", "Eigen/Dense"],
    "estimator/calibration/a.cc": ["estimator/smoother/a.h", "ceres/ceres.h"],
    "profiles/a.cc": ["estimator/smoother/a.h", "ingest/reference/a.h"],
    "export/a.cc": ["export/a.h", "ingest/flight/problem.h"],
    "export/mcap/a.cc": ["export/a.h", "ingest/mcap/writer.h", "google/protobuf/message.h"],
    "export/pipeline/a.cc": ["ingest/open/open.h", "estimator/calibration/a.h", "export/csv/csv.h"],
    "cli/a.cc": ["export/pipeline/a.h", "CLI/CLI.hpp"],
    "examples/a.cc": ["cli/a.h", "ceres/ceres.h"],
}


def tree(files):
    folder = tempfile.TemporaryDirectory()
    for path, text in files.items():
        file = pathlib.Path(folder.name, path)
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    return folder


class IncludeGraph(unittest.TestCase):
    def test_every_wrong_arrow_is_reported_at_its_line(self):
        for path, headers in WRONG.items():
            for header in headers:
                with self.subTest(path=path, header=header):
                    beside = f"{path.rsplit('/', 1)[0]}/beside.h"
                    with tree({path: f'#pragma once\n\n#include "{header}"\n', beside: ""}) as root:
                        _, complaints = include_graph.check(root)
                    self.assertEqual(len(complaints), 1, complaints)
                    self.assertTrue(complaints[0].startswith(f"{path}:3: {header} is "), complaints)

    def test_every_right_arrow_passes(self):
        files = {path: "".join(f"#include <{header}>\n" for header in headers) for path, headers in RIGHT.items()}
        with tree(files) as root:
            self.assertEqual(include_graph.check(root), (len(RIGHT), []))

    def test_an_arrow_behind_a_condition_or_with_odd_blanks_is_seen(self):
        with tree({"profiles/a.cc": "#if 0\n  #  include <ingest/open/open.h>\n#endif\n"}) as root:
            self.assertEqual(len(include_graph.check(root)[1]), 1)

    def test_a_comment_is_no_include(self):
        text = '// #include "cli/a.h"\n/* \n#include "cli/b.h"\n*/\n#include "export/a.h"\n'
        with tree({"profiles/a.cc": text}) as root:
            _, complaints = include_graph.check(root)
        self.assertEqual([c.split(" ")[0] for c in complaints], ["profiles/a.cc:5:"])

    def test_a_folder_without_a_row_is_reported(self):
        with tree({"export/new_product/a.cc": "", "ingest/a.cc": ""}) as root:
            self.assertEqual(len(include_graph.check(root)[1]), 2)


if __name__ == "__main__":
    unittest.main()
