#include <gtest/gtest.h>

#include "ingest/dataflash/dataflash_reader.h"
#include "ingest/dataflash/flight_from_dataflash.h"
#include "tests/ingest/dataflash/dataflash_writer.h"

namespace quadsonde::ingest {
namespace {

using support::DataflashWriter;

/// Names of all messages in order.
std::vector<std::string> names(Bytes bytes) {
  DataflashReader reader(bytes);
  DataflashMessage message;
  std::vector<std::string> names;
  while (reader.next(message)) names.push_back(message.layout->name);
  return names;
}

/// Reads to the end and gives the value of a field in the last message of a name, scaled.
double last_scaled(Bytes bytes, const std::string& name, const std::string& label) {
  DataflashReader reader(bytes);
  DataflashMessage message;
  double value = std::nan("");
  while (reader.next(message))
    if (message.layout->name == name) value = message.scaled(*message.layout->find(label));
  return value;
}

TEST(DataflashReader, ScalesEveryNumberOnce) {
  DataflashWriter log;
  log.define(20, "FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds");
  log.define(21, "MULT", "Qbd", "TimeUS,Id,Mult");
  log.define(1, "TEST", "QcLHB", "TimeUS,Angle,Lat,Millis,Plain");
  log.add("MULT", {0., double('F'), 1e-6});
  log.add("MULT", {0., double('B'), 0.01});
  log.add("MULT", {0., double('-'), 0.});
  log.add("MULT", {0., double('K'), 0.125});
  log.add("FMTU", {0., 1., std::string("sddm-"), std::string("FBGK-")});
  log.add("TEST", {5e6, 1234., 473565765., 80., 7.});
  EXPECT_DOUBLE_EQ(last_scaled(log.bytes, "TEST", "Angle"), 12.34) << "the letter and FMTU name one factor";
  EXPECT_DOUBLE_EQ(last_scaled(log.bytes, "TEST", "Lat"), 47.3565765);
  EXPECT_DOUBLE_EQ(last_scaled(log.bytes, "TEST", "TimeUS"), 5);
  EXPECT_DOUBLE_EQ(last_scaled(log.bytes, "TEST", "Millis"), 10) << "a factor that only this log's MULT tells";
  EXPECT_DOUBLE_EQ(last_scaled(log.bytes, "TEST", "Plain"), 7);
}

TEST(DataflashReader, ScalesByTheLettersAloneWithoutUnits) {
  DataflashWriter log;
  log.define(1, "TEST", "cCeELhM", "a,b,c,d,e,f,g");
  log.add("TEST", {-100., 100., -100., 100., 1e7, 100., 5.});
  const double expected[] = {-1, 1, -1, 1, 1, 100, 5};
  for (std::size_t i = 0; i < 7; ++i)
    EXPECT_DOUBLE_EQ(last_scaled(log.bytes, "TEST", std::string(1, static_cast<char>('a' + i))), expected[i]);
}

TEST(DataflashReader, ReadsHalfFloats) {
  DataflashWriter log;
  log.define(1, "HALF", "gggggg", "a,b,c,d,e,f");
  // Source: IEEE 754-2008 binary16: one, minus two, 65504 (largest), 2^-24 (smallest), infinity, NaN.
  log.add("HALF", {double(0x3C00), double(0xC000), double(0x7BFF), double(0x0001), double(0x7C00), double(0x7E00)});
  EXPECT_EQ(last_scaled(log.bytes, "HALF", "a"), 1);
  EXPECT_EQ(last_scaled(log.bytes, "HALF", "b"), -2);
  EXPECT_EQ(last_scaled(log.bytes, "HALF", "c"), 65504);
  EXPECT_EQ(last_scaled(log.bytes, "HALF", "d"), std::ldexp(1, -24));
  EXPECT_TRUE(std::isinf(last_scaled(log.bytes, "HALF", "e")));
  EXPECT_TRUE(std::isnan(last_scaled(log.bytes, "HALF", "f")));
}

TEST(DataflashReader, KeepsEveryCompleteMessageOfACutFile) {
  support::CopterLog log;
  std::vector<std::size_t> ends;
  log.fly();
  DataflashReader whole(log.bytes);
  DataflashMessage message;
  while (whole.next(message)) ends.push_back(whole.at());
  ASSERT_GT(ends.size(), 150u);
  for (std::size_t cut = 0; cut <= log.bytes.size(); ++cut) {
    DataflashReader reader(Bytes(log.bytes).first(cut));
    std::size_t messages = 0;
    while (reader.next(message)) ++messages;
    const auto complete = static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), cut) - ends.begin());
    ASSERT_EQ(messages, complete) << "cut at " << cut;
    ASSERT_EQ(reader.skipped_bytes(), 0u);
    ASSERT_EQ(reader.trailing_partial_bytes(), cut - (complete == 0 ? 0 : ends[complete - 1]));
  }
}

TEST(DataflashReader, LosesNoMessageToGarbageBetweenThem) {
  support::CopterLog log;
  log.fly();
  const auto clean = names(log.bytes);
  auto bytes = log.bytes;
  std::vector<std::uint8_t> garbage;
  for (int i = 0; i < 300; ++i) garbage.push_back(static_cast<std::uint8_t>(i * 37 + 11));
  garbage[100] = 0xA3, garbage[101] = 0x95, garbage[102] = 2;  // looks like a GPS message, is none
  DataflashReader reader(log.bytes);
  DataflashMessage message;
  for (int i = 0; i < 60; ++i) reader.next(message);
  bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(reader.at()), garbage.begin(), garbage.end());
  EXPECT_EQ(names(bytes), clean);
}

TEST(DataflashReader, MarksTheMessageThatGarbageMayHaveCutInto) {
  support::CopterLog log;
  log.attitude(1e6);
  const auto at = log.gps(2e6, {});
  for (int i = 0; i < 5; ++i) log.attitude(3e6 + i);
  auto bytes = log.bytes;
  bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at) + 20, 37, 0x55);
  DataflashReader reader(bytes);
  DataflashMessage message;
  std::vector<std::string> suspects;
  std::size_t attitudes = 0;
  while (reader.next(message)) {
    if (message.suspect) suspects.push_back(message.layout->name);
    if (message.layout->name == "ATT") ++attitudes;
  }
  EXPECT_EQ(suspects, std::vector<std::string>{"GPS"});
  EXPECT_EQ(attitudes, 6u);
  EXPECT_EQ(reader.skipped_bytes(), 37u);
  ASSERT_EQ(reader.first_losses().size(), 1u);
}

TEST(DataflashReader, SkipsByLengthWhatItCannotDecode) {
  DataflashWriter log;
  log.define(1, "NEW", "Qx", "TimeUS,What", 3 + 8 + 5);
  log.define(2, "LIE", "Qf", "TimeUS,x", 3 + 8);
  log.define(3, "OK", "B", "x");
  log.bytes.insert(log.bytes.end(), {0xA3, 0x95, 1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 0xA3, 0x95, 3});
  log.bytes.insert(log.bytes.end(), {0xA3, 0x95, 2, 1, 2, 3, 4, 5, 6, 7, 8});
  log.add("OK", {9.});
  EXPECT_EQ(names(log.bytes), (std::vector<std::string>{"FMT", "FMT", "FMT", "NEW", "LIE", "OK"}));
  DataflashReader reader(log.bytes);
  DataflashMessage message;
  while (reader.next(message)) {
  }
  EXPECT_TRUE(reader.layout("NEW")->fields.empty());
  EXPECT_TRUE(reader.layout("LIE")->fields.empty()) << "its length is not the sum of its fields";
}

TEST(DataflashReader, StepsOverTypesThatNoFormatMessageTells) {
  support::CopterLog log;
  log.attitude(1e6);
  log.bytes.insert(log.bytes.end(), {0xA3, 0x95, 200, 1, 2, 3, 4});
  log.attitude(2e6);
  const auto all = names(log.bytes);
  EXPECT_EQ(std::count(all.begin(), all.end(), "ATT"), 2);
}

TEST(DataflashReader, TakesANewMeaningOfATypeAfterARestart) {
  DataflashWriter log;
  log.define(1, "ONE", "B", "x");
  log.add("ONE", {1.});
  log.define(1, "TWO", "Bf", "x,y");
  log.add("TWO", {1., 2.5});
  EXPECT_EQ(names(log.bytes), (std::vector<std::string>{"FMT", "ONE", "FMT", "TWO"}));
  EXPECT_EQ(last_scaled(log.bytes, "TWO", "y"), 2.5);
}

TEST(DataflashReader, IsRecognisedBehindSomeGarbage) {
  support::CopterLog log;
  log.attitude(1e6);
  std::vector<std::uint8_t> bytes(1000, 0x42);
  bytes.insert(bytes.end(), log.bytes.begin(), log.bytes.end());
  EXPECT_TRUE(looks_like_dataflash(log.bytes));
  EXPECT_TRUE(looks_like_dataflash(bytes));
  EXPECT_FALSE(looks_like_dataflash(std::vector<std::uint8_t>(1000, 0x42)));
  EXPECT_FALSE(looks_like_dataflash({}));
  EXPECT_FALSE(read_dataflash(std::vector<std::uint8_t>(1000, 0x42), "x.bin"));
}

}  // namespace
}  // namespace quadsonde::ingest
