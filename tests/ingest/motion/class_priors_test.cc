#include "ingest/motion/class_priors.h"

#include <cmath>

#include "tests/support/data.h"

namespace quadsonde::ingest {
namespace {

TEST(ClassPriors, AreASoundTableAndEachNamesItsSources) {
  const auto read = parse_vehicle_classes(class_priors_text(), "class_priors.toml");
  ASSERT_TRUE(read) << to_string(read.error());
  ASSERT_EQ(read->size(), 5u);
  for (const auto& kind : *read) {
    EXPECT_FALSE(kind.what.empty()) << kind.name;
    EXPECT_TRUE(std::any_of(kind.sources.begin(), kind.sources.end(), [](const auto& s) { return s.used; }))
        << kind.name << " rests on nothing";
    EXPECT_GE(kind.relative_sd, 0.3) << kind.name;
    EXPECT_LE(kind.relative_sd, 0.5) << kind.name;
    const auto by_name = class_prior(kind.name);
    ASSERT_TRUE(by_name) << kind.name;
    EXPECT_TRUE(by_name->is_prior());
    EXPECT_EQ(by_name->id, "class:" + kind.name);
    EXPECT_NEAR(by_name->parameter_sd(p_linear), kind.relative_sd * by_name->drag.linear, 1e-12);
  }
}

// Units slip easily in a table of foreign numbers: 1/s against N s/m, kg against g, inches against metres.
TEST(ClassPriors, CoverAllMassesWithoutAGapAndGrowWithTheirRotors) {
  const auto& all = vehicle_classes();
  for (std::size_t i = 0; i + 1 < all.size(); ++i) {
    EXPECT_EQ(all[i].mass_kg.y(), all[i + 1].mass_kg.x()) << all[i].name;
    EXPECT_EQ(all[i].rotor_diameter_m.y(), all[i + 1].rotor_diameter_m.x()) << all[i].name;
    // From the small ones on a body grows slower than its mass: the air holds the heavier one less.
    if (i > 0) {
      EXPECT_GE(all[i].prior.drag.linear, all[i + 1].prior.drag.linear) << all[i].name;
    }
  }
}

TEST(ClassPriors, HoldEverySourceWithinTwoStandardDeviations) {
  for (const auto& kind : vehicle_classes())
    for (const auto& source : kind.sources) {
      if (!source.used) continue;
      ASSERT_TRUE(source.drag_per_s) << source.what;
      EXPECT_LE(std::abs(std::log(*source.drag_per_s / kind.prior.drag.linear)), 2 * kind.relative_sd) << source.what;
      if (source.mass_kg) {
        EXPECT_EQ(class_of(source.mass_kg, source.rotor_diameter_m), class_named(kind.name)) << source.what;
      }
    }
}

// Drags of recorded flights as PROVENANCE.md of the shared flights gives them, by plain least squares of others.
TEST(ClassPriors, HoldTheDragsOfRecordedFlightsWithinTwoStandardDeviations) {
  const struct {
    const char* logged_as;
    double drag;
  } flights[] = {{"Phantom 4 Pro", 0.216}, {"Phantom 4 RTK", 0.274}, {"Phantom 4 RTK", 0.259},
                 {"Matrice 200", 0.152},   {"Inspire 1 Pro", 0.122}, {"Matrice 300", 0.145},
                 {"M600 Pro", 0.153},      {"M600 Pro", 0.173},      {"DJI Inspire 2", 0.383}};
  for (const auto& flight : flights) {
    const auto* kind = class_known_as(flight.logged_as);
    ASSERT_TRUE(kind) << flight.logged_as;
    EXPECT_LE(std::abs(std::log(flight.drag / kind->prior.drag.linear)), 2 * kind->relative_sd) << flight.logged_as;
  }
}

TEST(ClassPriors, AreChosenByMassAndWithoutOneByTheRotors) {
  const auto name = [](const VehicleClass* kind) { return kind ? kind->name : "none"; };
  EXPECT_EQ(name(class_of(0.03, {})), "nano");
  EXPECT_EQ(name(class_of(0.25, 0.6)), "small") << "rotors of another class do not outweigh the mass";
  EXPECT_EQ(name(class_of(1.4, {})), "camera");
  EXPECT_EQ(name(class_of({}, 0.43)), "medium");
  EXPECT_EQ(name(class_of(2.2, 0.4)), "medium") << "on the border the rotors decide";
  EXPECT_EQ(name(class_of(2.2, 0.25)), "camera");
  EXPECT_EQ(name(class_of(90, {})), "heavy") << "half as much again is still near";
  EXPECT_EQ(name(class_of(500, {})), "none") << "nobody measured such a one";
  EXPECT_EQ(name(class_of({}, {})), "none");
  EXPECT_EQ(name(class_known_as("quad-07")), "none");
}

TEST(ClassPriors, RefuseATableWithAWrongKeyByItsLine) {
  const auto read = parse_vehicle_classes("[[class]]\nname = \"a\"\nmass = [1, 2]\n", "mine.toml");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().kind, Kind::usage);
  EXPECT_EQ(read.error().where.file, "mine.toml");
}

}  // namespace
}  // namespace quadsonde::ingest
