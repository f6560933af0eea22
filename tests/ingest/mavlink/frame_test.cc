#include <gtest/gtest.h>

#include "ingest/mavlink/mavlink_frame.h"
#include "tests/ingest/mavlink/mavlink_writer.h"

namespace quadsonde::ingest {
namespace {

using State = MavlinkProbe::State;

TEST(MavlinkCrc, HasTheCheckValueOfItsCatalogue) {
  // CRC-16/MCRF4XX of "123456789" is 0x6F91 (catalogue of parametrised CRC algorithms).
  EXPECT_EQ(mavlink_crc(as_bytes("123456789")), 0x6F91);
}

TEST(MavlinkCrc, IsTheSameInOnePieceAndInMany) {
  std::vector<std::uint8_t> bytes;
  for (int i = 0; i < 300; ++i) bytes.push_back(static_cast<std::uint8_t>(i * 31 + 7));
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut)
    ASSERT_EQ(mavlink_crc(Bytes(bytes).subspan(cut), mavlink_crc(Bytes(bytes).first(cut))), mavlink_crc(bytes));
}

/// CRC_EXTRA as the MAVLink guide defines it, from name and fields of the table.
std::uint8_t crc_extra(const MavlinkMessageInfo& info) {
  const std::map<std::string, std::string> names = {
      {"u8", "uint8_t"},  {"i8", "int8_t"},    {"u16", "uint16_t"}, {"i16", "int16_t"}, {"u32", "uint32_t"},
      {"i32", "int32_t"}, {"u64", "uint64_t"}, {"i64", "int64_t"},  {"f32", "float"},   {"char", "char"}};
  std::uint16_t crc = mavlink_crc(as_bytes(std::string(info.name) + " "));
  std::string_view rest = info.fields.substr(0, info.fields.find(" +"));
  while (!rest.empty()) {
    const auto word = rest.substr(0, rest.find(' '));
    rest.remove_prefix(std::min(rest.size(), word.size() + 1));
    const auto colon = word.find(':'), bracket = word.find('[');
    const auto name = word.substr(0, std::min(colon, bracket));
    crc = mavlink_crc(as_bytes(names.at(std::string(word.substr(colon + 1))) + " " + std::string(name) + " "), crc);
    if (bracket == std::string_view::npos) continue;
    const auto count = static_cast<std::uint8_t>(std::stoi(std::string(word.substr(bracket + 1))));
    crc = mavlink_crc(Bytes(&count, 1), crc);
  }
  return static_cast<std::uint8_t>((crc & 0xFF) ^ (crc >> 8));
}

TEST(MavlinkMessages, HaveTheSeedAndLengthThatTheirFieldsImply) {
  std::size_t checked = 0;
  for (const auto& info : mavlink_messages()) {
    if (info.fields.empty()) continue;
    // The group messages of ESCs are read through the first one's fields and carry their own name.
    EXPECT_EQ(crc_extra(info), info.crc_extra) << info.name;
    const auto fields = mavlink_fields(info);
    const auto& last = fields.back();
    const std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8, 1};
    EXPECT_EQ(last.offset + last.count * sizes[static_cast<std::size_t>(last.type)], info.max_length) << info.name;
    ++checked;
  }
  EXPECT_GE(checked, 20u);
}

TEST(MavlinkMessages, AreInOrderAndFoundByIdAndName) {
  std::uint32_t last = 0;
  for (const auto& info : mavlink_messages()) {
    EXPECT_TRUE(info.id == 0 || info.id > last);
    last = info.id;
    EXPECT_EQ(find_mavlink_message(info.id), &info);
    EXPECT_EQ(find_mavlink_message(info.name), &info);
    EXPECT_LE(info.base_length, info.max_length);
  }
  EXPECT_EQ(find_mavlink_message(std::uint32_t{3}), nullptr);
  EXPECT_EQ(find_mavlink_message(std::uint32_t{16777215}), nullptr);
}

TEST(MavlinkFrame, ComesBackFromBothVersionsSignedAndUnsigned) {
  for (const int version : {1, 2})
    for (const bool is_signed : {false, true}) {
      if (version == 1 && is_signed) continue;
      const auto bytes =
          support::mavlink_frame("ATTITUDE", {{"time_boot_ms", 1234}, {"roll", 0.5}}, {version, 7, 9, 42, is_signed});
      const auto probe = probe_mavlink(bytes);
      ASSERT_EQ(probe.state, State::complete);
      EXPECT_EQ(probe.length, bytes.size());
      EXPECT_EQ(probe.frame.system, 7);
      EXPECT_EQ(probe.frame.component, 9);
      EXPECT_EQ(probe.frame.sequence, 42);
      EXPECT_EQ(probe.frame.is_signed, is_signed);
      const PaddedPayload payload(probe.frame);
      const auto fields = mavlink_fields(*probe.frame.info);
      EXPECT_EQ(fields[0].integer(payload.data()), 1234);
      EXPECT_EQ(fields[1].number(payload.data()), 0.5);
      EXPECT_EQ(fields[6].number(payload.data()), 0) << "zeros cut off the end come back";
    }
}

TEST(MavlinkFrame, IsRefusedWhenAnyOfItsBytesIsWrong) {
  const auto bytes = support::mavlink_frame("ATTITUDE", {{"time_boot_ms", 1234}, {"yaw", 0.5}});
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    auto broken = bytes;
    broken[i] ^= 0x10;
    EXPECT_NE(probe_mavlink(broken).state, State::complete) << "byte " << i;
  }
}

TEST(MavlinkFrame, WithFlagsThatChangeItsMeaningIsNotRead) {
  auto bytes = support::mavlink_frame("ATTITUDE", {{"yaw", 0.5}});
  bytes[2] = 0x02;
  EXPECT_EQ(probe_mavlink(bytes).state, State::unsupported);
}

TEST(MavlinkStreamDecoder, GivesTheSameFramesWhateverThePiecesAre) {
  std::vector<std::uint8_t> link;
  std::vector<std::uint8_t> sent;
  for (std::uint8_t k = 0; k < 40; ++k) {
    support::FrameOptions options;
    options.version = 1 + k % 2;
    options.sequence = k;
    options.is_signed = k % 4 == 1;
    const auto frame = support::mavlink_frame("ATTITUDE", {{"time_boot_ms", k}, {"yawspeed", 1}}, options);
    link.insert(link.end(), frame.begin(), frame.end());
    if (k % 7 == 0) link.insert(link.end(), {0xFE, 0x00, 0xFD, 0x21});  // noise with magic bytes in it
    sent.push_back(k);
  }
  for (const std::size_t piece : {1u, 2u, 13u, 100u, 280u, 5000u}) {
    MavlinkStreamDecoder decoder;
    std::vector<std::uint8_t> heard;
    for (std::size_t at = 0; at < link.size(); at += piece)
      decoder.feed(Bytes(link).subspan(at, std::min(piece, link.size() - at)),
                   [&](const MavlinkFrame& frame) { heard.push_back(frame.sequence); });
    EXPECT_EQ(heard, sent) << "pieces of " << piece;
    EXPECT_EQ(decoder.frames(), sent.size());
    EXPECT_GT(decoder.skipped_bytes(), 0u);
  }
}

TEST(MavlinkStreamDecoder, StepsOverFramesOfForeignDialects) {
  auto foreign = support::mavlink_frame("ATTITUDE", {{"yaw", 1}});
  foreign[7] = 3;  // an id that no table has
  const auto good = support::mavlink_frame("HEARTBEAT", {{"type", 2}});
  std::vector<std::uint8_t> link = foreign;
  link.insert(link.end(), good.begin(), good.end());
  MavlinkStreamDecoder decoder;
  int heard = 0;
  decoder.feed(link, [&](const MavlinkFrame& frame) {
    ++heard;
    EXPECT_EQ(frame.info->name, "HEARTBEAT");
  });
  EXPECT_EQ(heard, 1);
  EXPECT_EQ(decoder.rejected(), 1u);
  EXPECT_EQ(decoder.skipped_bytes(), 0u);
}

}  // namespace
}  // namespace quadsonde::ingest
