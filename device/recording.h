// What a recording holds (docs/format.md): events in the order in which they happened, in zstd blocks that are each
// whole or lost.
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory_resource>
#include <string>
#include <variant>
#include <vector>

#include "core/map/bytes.h"
#include "core/world/world.h"
#include "frm.h"

namespace frm::device {

constexpr std::uint8_t recording_magic[8] = {0x89, 'F', 'R', 'R', '\r', '\n', 0x1A, '\n'};
constexpr std::uint32_t recording_version = 2;
constexpr std::uint32_t block_mark = 0x4B4C4246;  // "FBLK"

enum class EventType : std::uint8_t {
    world = 1,
    map,
    water,
    water_end,
    height,
    pressure,
    body,
    body_end,
    motion,
    tick,
    device,
    exchange,
    end
};

namespace event {

struct World {
    WorldDef def;
    std::uint32_t hash_interval = 0, axes = 0;
};
struct Map {
    std::vector<std::uint8_t> file;
};
struct Water {
    WaterDef def;
};
struct WaterEnd {};
struct Height {
    std::vector<float> values;
};
struct Pressure {
    std::vector<float> values;  ///< empty: taken away
};
struct Body {
    std::uint32_t id = 0, map = 0;
    BodyDef def;  ///< without the map
};
struct BodyEnd {
    std::uint32_t id = 0;
};
struct Motion {
    std::uint32_t id = 0;
    Pose pose;
    Twist twist;
};
struct Tick {
    float dt = 0;
    std::vector<Forces> forces;  ///< of every body there is
    bool has_hash = false;
    std::uint64_t hash = 0;
};
struct Device {
    std::uint32_t serial = 0;
    float max_force = 0, max_torque = 0;
    std::string name;
};
struct Exchange {
    std::uint32_t device = 0;
    frm_wrench command{};
    frm_device_state state{};
};
struct End {
    std::uint64_t ticks = 0;
};

}  // namespace event

using Event =
    std::variant<event::World, event::Map, event::Water, event::WaterEnd, event::Height, event::Pressure, event::Body,
                 event::BodyEnd, event::Motion, event::Tick, event::Device, event::Exchange, event::End>;

/// Appends events to a file `path`.part, which close() renames to `path`.
class RecordingWriter {
public:
    /// Throws Error (FRM_ERROR_FILE).
    explicit RecordingWriter(const char* path);
    ~RecordingWriter();
    RecordingWriter(const RecordingWriter&) = delete;
    RecordingWriter& operator=(const RecordingWriter&) = delete;

    void write(const Event& event);
    /// Compresses what has gathered into one block and hands it to the system. A failure is kept for close().
    void flush();
    /// Throws Error (FRM_ERROR_FILE), and leaves the .part file, if anything went wrong since the start.
    void close();

private:
    void put(const void* data, std::size_t size);

    std::string path_, part_;
    std::FILE* file_ = nullptr;
    int failure_ = 0;  ///< errno of the first write that failed
    std::uint32_t ticks_ = 0;
    std::vector<std::uint8_t> raw_, stored_;
};

/// Reads a recording front to back. A block that is cut off ends it.
class RecordingReader {
public:
    /// Throws Error: FRM_ERROR_FILE, FRM_ERROR_CORRUPT, FRM_ERROR_VERSION.
    explicit RecordingReader(const char* path);

    /// False at the end. Throws Error (FRM_ERROR_CORRUPT) for damage that is not a cut-off end.
    bool next(Event& event);
    bool torn() const { return torn_; }
    void rewind();

private:
    bool next_block();

    std::string path_;
    std::vector<std::uint8_t> file_, raw_;
    std::size_t at_file_ = 0, at_raw_ = 0, blocks_ = 0;
    bool torn_ = false, ended_ = false;
    std::uint32_t version_ = 0;
};

}  // namespace frm::device
