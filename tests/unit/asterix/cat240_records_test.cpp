// CAT 240 byte by byte, decoded by hand from EUROCONTROL-SPEC-0149-240, edition 1.3.
// When datagrams are due, and that they go out in order.
#include "server/asterix/cat240_records.h"

#include <gtest/gtest.h>

#include <numeric>
#include <string>
#include <vector>

#include "server/asterix/paced_sender.h"
#include "terrain/base/errors.h"
#include "tests/support/loopback.h"
namespace obliq::asterix::cat240_records_test {
namespace {

std::string hex(std::span<const std::byte> bytes) {
  std::string text;
  for (const std::byte byte : bytes) {
    constexpr char kDigits[] = "0123456789ABCDEF";
    text += kDigits[std::to_integer<int>(byte) >> 4];
    text += kDigits[std::to_integer<int>(byte) & 15];
    text += ' ';
  }
  if (!text.empty()) text.pop_back();
  return text;
}

std::uint64_t number_at(const Bytes& bytes, std::size_t at, int octets) {
  std::uint64_t value = 0;
  for (int i = 0; i < octets; ++i)
    value = value << 8 | std::to_integer<std::uint64_t>(bytes[at + static_cast<std::size_t>(i)]);
  return value;
}

TEST(Cat240Records, ASummaryHasItsFourItems) {
  Bytes bytes = summary_message({7, 200}, "main; 0 no return");
  stamp(bytes, 1'500'000'000);  // 1970-01-01T00:00:01.5Z
  EXPECT_EQ(hex(bytes),
            "F0 00 1D D1 08 "  // category 240, 29 octets, FSPEC
            "07 C8 "           // 010: SAC 7, SIC 200
            "01 "              // 000: summary
            "11 "              // 030: 17 characters
            "6D 61 69 6E 3B 20 30 20 6E 6F 20 72 65 74 75 72 6E "
            "00 00 C0");  // 140: 192 / 128 s
}

TEST(Cat240Records, ASummaryIsPrintableAsciiAndNotLongerThanItsItem) {
  const Bytes bytes = summary_message({}, "r\xC3\xA4" + std::string("dar\n") + std::string(300, 'x'));
  EXPECT_EQ(number_at(bytes, 8, 1), 255u);
  EXPECT_EQ(bytes.size(), 3u + 2 + 2 + 1 + 1 + 255 + 3);
  EXPECT_EQ(number_at(bytes, 1, 2), bytes.size());
  EXPECT_EQ(hex(std::span(bytes).subspan(9, 7)), "72 3F 3F 64 61 72 3F");
}

TEST(Cat240Records, AVideoMessageOf8BitsHasItsNineItems) {
  const std::vector<std::uint16_t> levels = {0, 1, 254, 255};
  VideoFormat format;
  format.source = {1, 2};
  format.cells = {0x01020304, 0x0A0B0C0D, 0};
  std::uint32_t index = 0xFFFFFFFF;
  std::vector<Bytes> messages;
  append_video(format, {{0x1111, 0x2222}, levels}, index, messages);
  ASSERT_EQ(messages.size(), 1u);
  stamp(messages[0], 86'399'999'999'999);  // the last moment of a day
  std::string zeros;
  for (int i = 0; i < 60; ++i) zeros += "00 ";
  EXPECT_EQ(hex(messages[0]),
            "F0 00 63 E7 A8 "                       // category 240, 99 octets, FSPEC
            "01 02 "                                // 010
            "02 "                                   // 000: video
            "FF FF FF FF "                          // 020: message index
            "11 11 22 22 01 02 03 04 0A 0B 0C 0D "  // 041: START_AZ, END_AZ, START_RG, CELL_DUR
            "00 04 "                                // 048: not compressed, 8 bits
            "00 04 00 00 04 "                       // 049: 4 valid octets, 4 cells
            "01 "                                   // 051: one block of 64 octets
            "00 01 FE FF " +
                zeros + "A8 BF FF");  // 140: 86400 * 128 - 1
  EXPECT_EQ(index, 0u) << "the index begins again behind 2^32 - 1";
}

TEST(Cat240Records, LevelsOf16BitsAreBigEndian) {
  const std::vector<std::uint16_t> levels = {0x0102, 0xFFFE};
  VideoFormat format;
  format.bits = 16;
  std::uint32_t index = 0;
  std::vector<Bytes> messages;
  append_video(format, {{}, levels}, index, messages);
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(hex(std::span(messages[0]).subspan(24, 13)), "00 05 00 04 00 00 02 01 01 02 FF FE 00");
}

TEST(Cat240Records, ARadialThatDoesNotFitIsSplitWithRisingStartRange) {
  std::vector<std::uint16_t> levels(1024);
  std::iota(levels.begin(), levels.end(), std::uint16_t{1});
  VideoFormat format;
  format.bits = 16;
  format.cells.start_rg = 50;
  std::uint32_t index = 9;
  std::vector<Bytes> messages;
  append_video(format, {{3, 4}, levels}, index, messages);
  // 22 blocks of 64 octets go into 1472 octets: 704 cells, and then 320.
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_EQ(index, 11u);
  EXPECT_EQ(messages[0].size(), 35u + 22 * 64);
  EXPECT_EQ(messages[1].size(), 35u + 10 * 64);
  std::vector<std::uint16_t> got;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const Bytes& bytes = messages[i];
    EXPECT_EQ(number_at(bytes, 1, 2), bytes.size());
    EXPECT_EQ(number_at(bytes, 8, 4), 9 + i);
    EXPECT_EQ(number_at(bytes, 12, 4), 0x00030004u);
    EXPECT_EQ(number_at(bytes, 16, 4), i == 0 ? 50u : 754u);
    const auto cells = static_cast<std::size_t>(number_at(bytes, 28, 3));
    EXPECT_EQ(number_at(bytes, 26, 2), 2 * cells);
    for (std::size_t k = 0; k < cells; ++k)
      got.push_back(static_cast<std::uint16_t>(number_at(bytes, 32 + 2 * k, 2)));
  }
  EXPECT_EQ(got, levels);

  messages.clear();
  format.max_datagram = 2083;
  append_video(format, {{3, 4}, levels}, index, messages);
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0].size(), 2083u);
}

TEST(Cat240Records, OfALargeDatagramTheBlocksAreThoseOf256Octets) {
  const std::vector<std::uint16_t> levels(20000, 7);
  VideoFormat format;
  format.max_datagram = kMostDatagram;
  std::uint32_t index = 0;
  std::vector<Bytes> messages;
  append_video(format, {{}, levels}, index, messages);
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(number_at(messages[0], 3, 2), 0xE798u);
  EXPECT_EQ(number_at(messages[0], 26, 2), 20000u);
  EXPECT_EQ(number_at(messages[0], 31, 1), 79u);  // 20000 / 256, rounded up
  EXPECT_EQ(messages[0].size(), 35u + 79 * 256);
}

TEST(Cat240Records, NoMessageIsLargerThanTheDatagram) {
  for (const std::size_t most :
       {least_datagram(), std::size_t{100}, std::size_t{1472}, std::size_t{16419}, kMostDatagram}) {
    for (const std::size_t cells : {1u, 63u, 64u, 65u, 4096u, 16384u, 60000u}) {
      for (const int bits : {8, 16}) {
        const std::vector<std::uint16_t> levels(cells, 1);
        VideoFormat format;
        format.bits = bits;
        format.max_datagram = most;
        std::uint32_t index = 0;
        std::vector<Bytes> messages;
        append_video(format, {{}, levels}, index, messages);
        std::uint64_t seen = 0;
        for (const Bytes& bytes : messages) {
          EXPECT_LE(bytes.size(), most);
          EXPECT_EQ(number_at(bytes, 16, 4), seen);
          seen += number_at(bytes, 28, 3);
        }
        EXPECT_EQ(seen, cells) << most << " " << bits;
      }
    }
  }
}

TEST(Cat240Cells, ACellLastsThereAndBack) {
  // 20.02 m: 2 x 20.02 / 299792458 s.
  const CellGeometry cells = cell_geometry(2000, 20.02);
  EXPECT_EQ(cells.cell_dur_fs, 133'559'064u);
  EXPECT_EQ(cells.start_rg, 100u);  // 99.9
  EXPECT_NEAR(cells.range_offset_m, 2.0, 1e-9);
  EXPECT_EQ(cell_geometry(4000, 20).range_offset_m, 0) << "r_min is a multiple of the bin";
  // Rounding CELL_DUR puts the end of 1224 cells off by less than a tenth of a millimetre.
  const double end_m = 1224 * (cells.cell_dur_fs * 1e-15 * 299'792'458.0 / 2);
  EXPECT_NEAR(end_m, 1224 * 20.02, 1e-4);
}

TEST(Cat240Cells, TheLongestCellIsThatOf32Bits) {
  EXPECT_NEAR(longest_cell_m(), 643.7994, 1e-4);
  EXPECT_EQ(cell_geometry(0, longest_cell_m()).cell_dur_fs, 0xFFFFFFFFu);
}

TEST(Cat240Cells, NeighboursMeetExactlyAlsoAcrossNorth) {
  constexpr double kStart_deg = -30, kWidth_deg = 360.0 / 1021;
  for (std::uint32_t bin = 0; bin < 1021; ++bin) {
    EXPECT_EQ(azimuth_edges(kStart_deg, kWidth_deg, bin).end,
              azimuth_edges(kStart_deg, kWidth_deg, bin + 1).start);
  }
  EXPECT_EQ(azimuth_edges(kStart_deg, kWidth_deg, 0).start, azimuth_edges(kStart_deg, kWidth_deg, 1020).end);
  EXPECT_EQ(azimuth_units(0), 0);
  EXPECT_EQ(azimuth_units(90), 16384);
  EXPECT_EQ(azimuth_units(-90), 49152);
  EXPECT_EQ(azimuth_units(450), 16384);
  EXPECT_EQ(azimuth_units(359.9999), 0) << "rounds to north";
}

using namespace std::chrono_literals;
using Clock = Pace::Clock;

TEST(Cat240Pace, DatagramsAreSpreadEvenlyOverThePeriod) {
  Pace pace;
  const Clock::time_point now{10s};
  const auto times = pace.spread(now, 1000, 100ms);
  EXPECT_EQ(times.at(0), now);
  EXPECT_EQ(times.at(500), now + 50ms);
  const auto next = pace.spread(now + 100ms, 1000, 100ms);
  EXPECT_EQ(next.at(0), now + 100ms);
}

TEST(Cat240Pace, AFrameThatComesEarlyFollowsTheOneBeforeItAndEndsInTime) {
  Pace pace;
  const Clock::time_point now{10s};
  (void)pace.spread(now, 1000, 100ms);
  const auto early = pace.spread(now + 40ms, 400, 100ms);
  EXPECT_EQ(early.at(0), now + 100ms);
  EXPECT_EQ(early.at(400), now + 140ms);
}

TEST(Cat240Pace, FramesInABurstAreNotSqueezedToNothing) {
  Pace pace;
  const Clock::time_point now{10s};
  Clock::time_point end = now;
  for (int frame = 0; frame < 5; ++frame) {
    const auto times = pace.spread(now, 1000, 100ms);
    EXPECT_GE(times.at(0), end);
    EXPECT_GE(times.step, 25us);
    end = times.at(1000);
  }
}

TEST(Cat240Pace, ThePeriodIsThatOfTheFramesAndNotOfOnePause) {
  FramePeriod period(10);
  Clock::time_point now{10s};
  EXPECT_EQ(period.next(now), 100ms);
  EXPECT_EQ(period.next(now += 250ms), 100ms);
  EXPECT_EQ(period.next(now += 250ms), 250ms) << "the server renders four frames a second";
  EXPECT_EQ(period.next(now += 60s), 250ms) << "a pause";
  EXPECT_EQ(period.next(now += 250ms), 250ms);
  EXPECT_EQ(period.next(now += 1ms), 100ms) << "never closer than was asked for";
}

TEST(Cat240Pace, DwellsOfAReplayThatIsFasterThanTheAntennaWasDoNotPileUp) {
  Pace pace;
  DwellPeriod dwells;
  Clock::time_point now{10s};
  for (int dwell = 0; dwell < 1000; ++dwell) {  // ten times as fast
    now += 4ms;
    const auto times = pace.spread(now, 8, dwells.next(now, 40ms));
    EXPECT_LT(times.at(0) - now, 200ms) << dwell;
  }
  EXPECT_NEAR(std::chrono::duration<double>(dwells.next(now + 4ms, 40ms)).count(), 0.004, 1e-4);
}

TEST(Cat240Pace, DwellsThatComeBunchedAreSpreadAsTheBeamMoves) {
  Pace pace;
  DwellPeriod dwells;
  Clock::time_point now{10s};
  for (int dwell = 0; dwell < 100; ++dwell) {
    now += dwell % 5 == 0 ? 196ms : 1ms;  // five every 200 ms
    const auto times = pace.spread(now, 8, dwells.next(now, 40ms));
    EXPECT_GT(times.step, 500us) << dwell;
    EXPECT_LT(times.at(0) - now, 250ms);
  }
}

/// A socket of the loopback that receives.
class Receiver {
 public:
  Receiver() : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    to = "127.0.0.1:" + std::to_string(test::bind_to_loopback(socket_.get()));
  }
  Bytes receive() {
    Bytes bytes(kMostDatagram);
    const ssize_t size = recv(socket_.get(), bytes.data(), bytes.size(), 0);
    bytes.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
    return bytes;
  }
  std::string to;

 private:
  UniqueFd socket_;
};

TEST(Cat240Sender, DatagramsArriveInOrderWithTheirTimeOfDay) {
  Receiver receiver;
  PacedSender sender(UdpTarget({.to = receiver.to}));
  std::vector<Bytes> messages;
  for (int i = 0; i < 40; ++i) messages.push_back(summary_message({}, std::to_string(i)));
  const std::int64_t noon_ns = 12 * 3600 * std::int64_t{1'000'000'000};
  sender.queue(messages, {Clock::now(), 1ms}, noon_ns);
  for (Bytes& expected : messages) {
    stamp(expected, noon_ns);
    EXPECT_EQ(receiver.receive(), expected);
  }
  sender.drain();
  EXPECT_EQ(sender.counts().sent, 40u);
  EXPECT_EQ(sender.counts().not_sent, 0u);
}

TEST(Cat240Sender, WhatTheKernelDoesNotTakeIsCounted) {
  // A datagram that is too long for UDP.
  PacedSender sender(UdpTarget({.to = "127.0.0.1:9"}));
  sender.queue({Bytes(70000), Bytes(70000)}, {Clock::now(), {}}, 0);
  sender.drain();
  EXPECT_EQ(sender.counts().not_sent, 2u);
  EXPECT_EQ(sender.counts().error, EMSGSIZE);
  EXPECT_EQ(sender.counts().sent, 0u);
}

TEST(Cat240Sender, BadAddressesAreRefusedWithWhatIsAllowed) {
  for (const char* to :
       {"", "8600", "127.0.0.1", "127.0.0.1:", "127.0.0.1:0", "127.0.0.1:65536", "127.0.0.1:86x", ":8600",
        "300.1.1.1:8600", "::1:8600", "0.0.0.0:8600", "255.255.255.255:8600"}) {
    try {
      UdpTarget target({.to = to});
      FAIL() << to;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(std::string("--to: found \"") + to + "\""), std::string::npos)
          << error.what();
      EXPECT_NE(std::string(error.what()).find("allowed: HOST:PORT"), std::string::npos) << error.what();
    }
  }
  for (const char* to : {"[::1]:8600", "::1:8600", "::1", "fe80::1%eth0:8600"}) {
    try {
      UdpTarget target({.to = to});
      FAIL() << to;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("an IPv6 address: CAT 240 is sent over IPv4 only"),
                std::string::npos)
          << error.what();
    }
  }
  for (const char* interface : {"lo", "203.0.113.7", "1.2.3"}) {
    try {
      UdpTarget target({.to = "239.192.24.1:8600", .interface = interface});
      FAIL() << interface;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(std::string("--interface: found \"") + interface + "\""),
                std::string::npos)
          << error.what();
    }
  }
}

TEST(Cat240Sender, AMulticastGroupOnTheLoopbackIsHeard) {
  UniqueFd socket(::socket(AF_INET, SOCK_DGRAM, 0));
  const std::uint16_t port = test::bind_to_loopback(socket.get(), INADDR_ANY);
  ip_mreq group{};
  group.imr_multiaddr.s_addr = inet_addr("239.192.24.1");
  group.imr_interface.s_addr = htonl(INADDR_LOOPBACK);
  if (setsockopt(socket.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof group) != 0)
    GTEST_SKIP() << "this machine has no multicast";
  PacedSender sender(
      UdpTarget({.to = "239.192.24.1:" + std::to_string(port), .interface = "127.0.0.1", .ttl = 3}));
  sender.queue({summary_message({}, "hello")}, {Clock::now(), {}}, 0);
  sender.drain();
  ASSERT_EQ(sender.counts().sent, 1u);
  Bytes bytes(100);
  EXPECT_EQ(recv(socket.get(), bytes.data(), bytes.size(), 0), 17);
}

}  // namespace
}  // namespace obliq::asterix::cat240_records_test
