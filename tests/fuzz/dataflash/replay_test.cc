#include "tests/fuzz/replay.h"

TEST(DataflashCorpus, IsReadWithoutACrash) { EXPECT_GE(quadsonde::fuzz::replay(CORPUS), 5u); }
