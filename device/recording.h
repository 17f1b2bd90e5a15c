// What a recording holds (docs/format.md): events in the order in which they happened, in blocks that are each whole or
// lost.
#pragma once

#include <cstdint>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "core/map/bytes.h"
#include "core/math/hash.h"
#include "core/world/world.h"
#include "frm.h"

namespace frm::device {

constexpr std::uint8_t recording_magic[8] = {0x89, 'F', 'R', 'R', '\r', '\n', 0x1A, '\n'};
constexpr std::uint32_t recording_version = 3;
constexpr std::uint8_t index_magic[8] = {'F', 'R', 'R', 'I', 'N', 'D', 'E', 'X'};  ///< at the end of the file
constexpr std::uint32_t block_mark = 0x4B4C4246;                                   // "FBLK"
constexpr std::uint64_t largest_block = std::uint64_t{1} << 31;

/// Of a block's head, and of its contents: 64-bit FNV-1a, its halves exclusive-or.
inline std::uint32_t check_of(const std::uint8_t* data, std::size_t size) {
    const std::uint64_t hash = fnv1a(data, size);
    return static_cast<std::uint32_t>(hash ^ hash >> 32);
}

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
    end,
    gap
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
    std::uint64_t tick = 0;  ///< of the world after it; counted by the reader in versions before 3
    double time = 0;         ///< of the world after it
    float dt = 0;
    std::vector<Forces> forces;  ///< of every body there is
    /// Instead of them, in ticks between two that have them: checks_of() of each body.
    std::vector<std::uint32_t> checks;
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
    /// False in exchanges between two that have them: command and the wrench achieved (in the state) are 0 then.
    bool has_wrenches = true;
    frm_wrench command{};
    frm_device_state state{};
    std::vector<std::uint8_t> raw;  ///< as the driver read it; empty: nothing
};
struct End {
    std::uint64_t ticks = 0;
};
/// Here events are missing: the writer could not follow.
struct Gap {
    std::uint64_t events = 0;
};

}  // namespace event

using Event =
    std::variant<event::World, event::Map, event::Water, event::WaterEnd, event::Height, event::Pressure, event::Body,
                 event::BodyEnd, event::Motion, event::Tick, event::Device, event::Exchange, event::End, event::Gap>;

/// Eight bits of a hash of each part: buoyancy (lowest), pressure, friction, gravity. The total is their sum.
inline std::uint32_t checks_of(const Forces& f) {
    std::uint32_t checks = 0;
    const Wrench* const parts[] = {&f.buoyancy, &f.pressure, &f.friction, &f.gravity};
    for (int i = 0; i < 4; ++i) {
        const std::uint64_t hash = fnv1a(parts[i], sizeof(Wrench));
        checks |= static_cast<std::uint32_t>((hash ^ hash >> 32) & 0xFF) << (8 * i);
    }
    return checks;
}

/// Largest packet of a device that is recorded, bytes.
constexpr std::uint32_t largest_packet = 512;

/// A block closes with the tick that makes it this long, or with this many ticks or events: what a killed process loses.
constexpr double frame_seconds = 0.04;
constexpr std::uint32_t frame_ticks = 128, frame_events = 4096;
/// A block that begins a run holds the last motion of every body besides.
constexpr std::uint32_t most_events = frame_events + 65536;
/// From where to where columns learn: one can start reading every so often.
constexpr double run_seconds = 10;
constexpr std::uint32_t run_ticks = 10000;

enum class BlockKind : std::uint32_t { bytes = 0, columns = 1, first_columns = 2, index = 3 };

/// Where a block is, and what came before it.
struct BlockPlace {
    std::uint64_t offset = 0, tick = 0;
    double time = 0;
    BlockKind kind = BlockKind::bytes;
    std::uint32_t stored = 0, raw = 0;
};

class ColumnWriter;
class ColumnReader;

/// Appends events to a file `path`.part, which close() renames to `path`.
class RecordingWriter {
public:
    /// Throws Error (FRM_ERROR_FILE).
    explicit RecordingWriter(const char* path);
    ~RecordingWriter();
    RecordingWriter(const RecordingWriter&) = delete;
    RecordingWriter& operator=(const RecordingWriter&) = delete;

    void write(const Event& event);
    /// Closes the block and hands it to the system. A failure is kept for close().
    void flush();
    /// Throws Error (FRM_ERROR_FILE), and leaves the .part file, if anything went wrong since the start.
    void close();
    std::uint64_t bytes() const { return offset_; }

private:
    void start_run();
    void put(const void* data, std::size_t size);
    void put_block(BlockKind kind, std::size_t raw, const std::vector<std::uint8_t>& contents);
    void write_index();

    std::string path_, part_;
    std::FILE* file_ = nullptr;
    int failure_ = 0;  ///< errno of the first write that failed
    std::uint64_t offset_ = 0, tick_ = 0;
    double time_ = 0;
    std::uint64_t block_tick_ = 0;  ///< before the open block
    double block_time_ = 0;
    std::uint64_t run_tick_ = 0;  ///< where the columns began to learn
    double run_time_ = 0;
    std::uint32_t events_ = 0;
    bool fresh_ = true;  ///< columns begin with the open block
    std::unique_ptr<ColumnWriter> columns_;
    std::vector<std::uint8_t> raw_, stored_;
    std::map<std::uint32_t, event::Motion> motions_;  ///< the last of each body
    std::vector<BlockPlace> index_;
};

/// Reads a recording, block by block. A block that is cut off ends it.
class RecordingReader {
public:
    /// Throws Error: FRM_ERROR_FILE, FRM_ERROR_CORRUPT, FRM_ERROR_VERSION.
    explicit RecordingReader(const char* path);
    ~RecordingReader();
    RecordingReader(const RecordingReader&) = delete;
    RecordingReader& operator=(const RecordingReader&) = delete;

    /// False at the end. Throws Error (FRM_ERROR_CORRUPT) for damage that is not a cut-off end.
    bool next(Event& event);
    bool torn() const { return torn_; }
    void rewind();
    /// Goes to a place from which every tick after `tick` is still to come, as near as the index has one. Of what was before,
    /// next() gives what is not of every tick (worlds, bodies, devices, heights), then the motions that last. False if the
    /// file has no index, and the places had to be looked for.
    bool seek(std::uint64_t tick) { return seek(tick, 1e300); }
    bool seek_time(double seconds) { return seek(~std::uint64_t{0}, seconds); }
    /// Of the file that has been read, 0 to 1.
    double share() const { return static_cast<double>(at_file_) / static_cast<double>(size_); }
    std::uint32_t version() const { return version_; }

private:
    bool seek(std::uint64_t tick, double time);
    void read(std::uint64_t offset, void* data, std::size_t size);
    bool read_place(std::uint64_t offset, BlockPlace& place);
    bool next_block();
    void jump();
    bool next_block_before_3();
    void unpack(const BlockPlace& place);
    bool read_index(std::vector<BlockPlace>& index);
    void scan(std::vector<BlockPlace>& index);
    [[noreturn]] void damaged(const char* what) const;

    std::string path_;
    std::FILE* file_ = nullptr;
    std::uint64_t size_ = 0, at_file_ = 0, blocks_ = 0, tick_ = 0;
    double time_ = 0;
    std::vector<std::uint8_t> stored_, raw_;
    std::size_t at_raw_ = 0;
    std::uint32_t events_left_ = 0;  ///< of a block of columns
    std::vector<BlockPlace> jumps_;  ///< where to go on after a seek, last first
    std::unique_ptr<ColumnReader> columns_;
    bool torn_ = false, ended_ = false;
    std::uint32_t version_ = 0;
};

}  // namespace frm::device
