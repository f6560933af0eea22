#include "tests/fuzz/replay.h"

TEST(CompareCorpus, IsComparedWithoutACrash) { EXPECT_GE(quadsonde::fuzz::replay(CORPUS), 8u); }
