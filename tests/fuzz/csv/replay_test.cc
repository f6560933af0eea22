#include "tests/fuzz/replay.h"

TEST(CsvCorpus, IsReadWithoutACrash) { EXPECT_GE(quadsonde::fuzz::replay(CORPUS), 5u); }
