#include "tests/fuzz/replay.h"

TEST(MavlinkCorpus, IsReadWithoutACrash) { EXPECT_GE(quadsonde::fuzz::replay(CORPUS), 5u); }
