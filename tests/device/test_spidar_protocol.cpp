// The amplifiers' packets, byte by byte as they are documented, and counters that wrap.
#include "device/spidar_g/sh4.h"
#include "device/spidar_g/simple.h"
#include "tests/device/spidar_g.h"

using namespace frm;
using namespace frm::test;

namespace {

const Digits digits{0, 1, -1, 0x1234, -0x1234, 32767, -32768, 3032};

}  // namespace

TEST_CASE("SH4 packets", "[spidar_g]") {
    const Sh4 sh4;
    CHECK(sh4.opening().count == 0);
    Request request;
    sh4.request(digits, request);
    REQUIRE(request.count == 1);
    const Packet& p = request.packets[0];
    CHECK(p.size == 512);
    CHECK(p.bytes[0] == 0x01);
    CHECK(p.bytes[1] == 0x0E);
    const std::uint8_t expected[16] = {0, 0, 1, 0, 0xFF, 0xFF, 0x34, 0x12, 0xCC, 0xED, 0xFF, 0x7F, 0, 0x80, 0xD8, 0x0B};
    for (std::size_t i = 0; i < 16; ++i) CHECK(p.bytes[2 + i] == expected[i]);
    for (std::size_t i = 18; i < 512; ++i) CHECK(p.bytes[i] == 0);

    // DAC echo, counters, A/D, PIO; a count is the counter's negative.
    std::uint8_t reply[512] = {};
    reply[16] = 1;                       // counter 0: 1
    reply[18] = 0xFF, reply[19] = 0xFF;  // counter 1: 65535
    reply[30] = 0x00, reply[31] = 0x80;  // counter 7: 32768
    reply[32] = 0x34, reply[33] = 0x02;  // A/D 0
    reply[46] = 0xFF, reply[47] = 0x0F;  // A/D 7
    reply[48] = 0xA5, reply[49] = 0x01;  // PIO
    Reading reading;
    REQUIRE(sh4.reply_size() == 512);
    sh4.read(reply, reading);
    CHECK(reading.counts == Counters{-1, 1, 0, 0, 0, 0, 0, -32768});
    CHECK(reading.analogue[0] == 0x0234);
    CHECK(reading.analogue[7] == 0x0FFF);
    CHECK(reading.pio == 0x01A5);
    CHECK(Amplifier::rotary_id(reading) == 10);

    Digits back{};
    CHECK(Sh4::read_request(p.bytes.data(), p.size, back));
    CHECK(back == digits);
    CHECK_FALSE(Sh4::read_request(p.bytes.data(), 511, back));
}

TEST_CASE("Simple packets", "[spidar_g]") {
    const Simple simple;
    const Request opening = simple.opening();
    REQUIRE(opening.count == 2);
    CHECK((opening.packets[0].bytes[0] == 0xA2 && opening.packets[0].bytes[1] == 0x1A &&
           opening.packets[0].bytes[2] == 0xFF));
    CHECK((opening.packets[1].bytes[0] == 0xA2 && opening.packets[1].bytes[1] == 0x19 &&
           opening.packets[1].bytes[2] == 0xFF));
    Request request;
    simple.request(digits, request);
    REQUIRE(request.count == 2);
    CHECK(request.packets[0].size == 32);
    CHECK(request.packets[1].size == 32);
    CHECK(request.packets[0].bytes[0] == 0x52);
    CHECK(request.packets[1].bytes[0] == 0x51);
    const std::uint8_t expected[16] = {0, 0, 1, 0, 0xFF, 0xFF, 0x34, 0x12, 0xCC, 0xED, 0xFF, 0x7F, 0, 0x80, 0xD8, 0x0B};
    for (std::size_t i = 0; i < 16; ++i) CHECK(request.packets[0].bytes[1 + i] == expected[i]);

    std::uint8_t reply[32] = {};
    reply[0] = 0x56, reply[1] = 0x34, reply[2] = 0x12;
    reply[3] = 0xFF, reply[4] = 0xFF, reply[5] = 0xFF;
    reply[21] = 0x00, reply[22] = 0x00, reply[23] = 0x80;
    reply[24] = 0x7C;
    Reading reading;
    REQUIRE(simple.reply_size() == 32);
    simple.read(reply, reading);
    CHECK(reading.counts == Counters{0x123456, -1, 0, 0, 0, 0, 0, -0x800000});
    CHECK(Amplifier::rotary_id(reading) == 7);
    CHECK((reading.pio & 0xF) == 12);
}

TEST_CASE("what the simulated amplifiers say is what is read", "[spidar_g]") {
    Random random;
    for (int k = 0; k < 2000; ++k) {
        Reading said, read;
        for (std::size_t i = 0; i < string_count; ++i) {
            said.counts[i] = static_cast<std::int16_t>(random(-32768, 32767));
            said.analogue[i] = static_cast<std::uint16_t>(random(0, 4095));
        }
        said.pio = static_cast<std::uint32_t>(random(0, 255));
        Packet packet;
        Sh4::write_reply({}, said, packet);
        Sh4().read(packet.bytes.data(), read);
        CHECK(read.counts == said.counts);
        CHECK(read.analogue == said.analogue);
        CHECK(read.pio == said.pio);
        for (auto& count : said.counts) count *= 200;
        Simple::write_reply(said, packet);
        Simple().read(packet.bytes.data(), read);
        CHECK(read.counts == said.counts);
        CHECK(read.pio == said.pio);
    }
}

TEST_CASE("counters are followed over many wraps, both ways", "[spidar_g]") {
    for (const std::int64_t range : {std::int64_t{65536}, std::int64_t{1} << 24}) {
        CounterExtension counters(range);
        Random random;
        std::array<std::int64_t, string_count> truth{};
        const auto wrapped = [&] {
            Counters out{};
            for (std::size_t i = 0; i < out.size(); ++i) {
                std::int64_t c = (truth[i] + 12345 * static_cast<std::int64_t>(i)) % range;
                if (c < 0) c += range;
                out[i] = static_cast<std::int32_t>(c >= range / 2 ? c - range : c);
            }
            return out;
        };
        CHECK(counters.add(wrapped()) == truth);
        for (int k = 0; k < 5000; ++k) {
            const double most = static_cast<double>(range / 2 - 1);
            for (std::size_t i = 0; i < truth.size(); ++i)
                truth[i] += static_cast<std::int64_t>(random(i % 2 ? -0.1 * most : -most, i % 2 ? most : 0.1 * most));
            CHECK(counters.add(wrapped()) == truth);
        }
        counters.reset();
        CHECK(counters.add(wrapped()) == std::array<std::int64_t, string_count>{});
    }
}
