#include "cli/recording_csv.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <optional>

#include "cli/command.h"
#include "cli/file.h"
#include "cli/progress.h"
#include "device/recording_columns.h"

namespace frm::cli {
namespace {

/// One row as it grows.
class Row {
public:
    void text(const std::string& t) {
        if (!row_.empty()) row_ += ',';
        row_ += t;
    }
    void whole(std::uint64_t v) { text(std::to_string(v)); }
    // As many digits as give the same bits when read again.
    void number(double v) { print("%.17g", v); }
    void number(float v) { print("%.9g", static_cast<double>(v)); }
    void empty(int cells) {
        for (int i = 0; i < cells; ++i) text("");
    }
    template <typename V>
    void vector(const V& v) {
        number(v.x), number(v.y), number(v.z);
    }
    template <typename P>
    void pose(const P& p) {
        vector(p.position), vector(p.rotation), number(p.rotation.w);
    }
    std::string line() const { return row_ + '\n'; }

private:
    void print(const char* format, double v) {
        char digits[40];
        std::snprintf(digits, sizeof digits, format, v);
        text(digits);
    }
    std::string row_;
};

constexpr const char* motion_columns = "px,py,pz,qx,qy,qz,qw,vx,vy,vz,wx,wy,wz";

std::string wrench_columns(const std::string& name) {
    std::string out;
    for (const char* c : {"fx", "fy", "fz", "tx", "ty", "tz"}) out += "," + name + c;
    return out;
}

std::string tick_head() {
    std::string head = std::string("tick,time,dt,body,") + motion_columns;
    for (const char* part : {"", "buoyancy_", "pressure_", "friction_", "gravity_"}) head += wrench_columns(part);
    return head + "\n";
}

std::string exchange_head() {
    return "tick,time,device" + wrench_columns("command_") + ",status," + motion_columns +
           ",grip,buttons,time_ns,sequence" + wrench_columns("achieved_") + ",faults,raw\n";
}

struct KnownBody {
    std::uint32_t id = 0;
    Pose pose;
    Twist twist;
};

class Tables {
public:
    Tables(const std::string& ticks, const std::string& exchanges, const Moment& from, const Moment& to)
        : from_(from), to_(to) {
        if (!ticks.empty()) ticks_ = std::make_unique<OutputFile>(ticks);
        if (!exchanges.empty()) exchanges_ = std::make_unique<OutputFile>(exchanges);
        if (ticks_) ticks_->write(tick_head());
        if (exchanges_) exchanges_->write(exchange_head());
    }

    /// False once there is nothing more to come within the range.
    bool take(const device::Event& e) {
        if (const auto* body = std::get_if<device::event::Body>(&e))
            bodies_.push_back({body->id, body->def.pose, body->def.twist});
        if (const auto* end = std::get_if<device::event::BodyEnd>(&e))
            bodies_.erase(
                std::remove_if(bodies_.begin(), bodies_.end(), [&](const KnownBody& b) { return b.id == end->id; }),
                bodies_.end());
        if (const auto* m = std::get_if<device::event::Motion>(&e))
            for (KnownBody& b : bodies_)
                if (b.id == m->id) b.pose = m->pose, b.twist = m->twist;
        if (const auto* exchange = std::get_if<device::event::Exchange>(&e)) add(*exchange);
        if (const auto* tick = std::get_if<device::event::Tick>(&e)) return add(*tick);
        counts.gap |= std::holds_alternative<device::event::Gap>(e);
        return true;
    }
    void commit() {
        if (ticks_) ticks_->commit();
        if (exchanges_) exchanges_->commit();
    }

    CsvCounts counts;

private:
    bool add(const device::event::Tick& e) {
        if (!not_after(to_, e.tick, e.time)) return false;
        const bool wanted = not_before(from_, e.tick, e.time);
        if (wanted && exchanges_)
            for (const std::string& line : waiting_) exchanges_->write(line);
        if (wanted) counts.exchanges += waiting_.size(), ++counts.ticks;
        waiting_.clear();
        tick_ = e.tick, time_ = e.time;
        if (!wanted || !ticks_) return true;
        const std::size_t bodies = std::max(e.forces.size(), e.checks.size());
        if (bodies != bodies_.size())
            throw Failure("tick " + std::to_string(e.tick) + ": its bodies are not those there");
        for (std::size_t i = 0; i < bodies; ++i) {
            Row row;
            row.whole(e.tick), row.number(e.time), row.number(e.dt), row.whole(bodies_[i].id);
            row.pose(bodies_[i].pose), row.vector(bodies_[i].twist.linear), row.vector(bodies_[i].twist.angular);
            if (e.forces.empty()) {
                row.empty(30);
            } else {
                const Forces& f = e.forces[i];
                for (const Wrench* w : {&f.total, &f.buoyancy, &f.pressure, &f.friction, &f.gravity})
                    row.vector(w->force), row.vector(w->torque);
            }
            ticks_->write(row.line());
        }
        return true;
    }
    /// An exchange belongs to the tick that follows it.
    void add(const device::event::Exchange& e) {
        Row row;
        row.whole(tick_ + 1), row.number(time_), row.whole(e.device);
        if (e.has_wrenches)
            row.vector(e.command.force), row.vector(e.command.torque);
        else
            row.empty(6);
        const frm_device_state& s = e.state;
        row.whole(s.status), row.pose(s.pose), row.vector(s.twist.linear), row.vector(s.twist.angular);
        row.number(s.grip), row.whole(s.buttons), row.whole(s.time_ns), row.whole(s.sequence);
        if (e.has_wrenches)
            row.vector(s.achieved.force), row.vector(s.achieved.torque);
        else
            row.empty(6);
        row.whole(s.faults);
        std::string hex;
        for (const std::uint8_t byte : e.raw) {
            char two[3];
            std::snprintf(two, sizeof two, "%02x", byte);
            hex += two;
        }
        row.text(hex);
        waiting_.push_back(row.line());
    }

    const Moment &from_, &to_;
    std::unique_ptr<OutputFile> ticks_, exchanges_;
    std::vector<KnownBody> bodies_;
    std::vector<std::string> waiting_;  ///< exchanges since the last tick
    std::uint64_t tick_ = 0;
    double time_ = 0;
};

}  // namespace

bool parse_moment(const std::string& text, Moment& out) {
    if (text.empty() || text[0] < '0' || text[0] > '9') return false;
    char* end = nullptr;
    if (text.back() == 't') {
        out.tick = std::strtoull(text.c_str(), &end, 10);
        out.seconds = -1;
        out.given = true;
        return end == text.c_str() + text.size() - 1;
    }
    out.seconds = std::strtod(text.c_str(), &end);
    out.given = true;
    return *end == 0 && out.seconds <= 1e12;
}

bool not_before(const Moment& from, std::uint64_t tick, double time) {
    return !from.given || (from.seconds >= 0 ? time >= from.seconds : tick >= from.tick);
}

bool not_after(const Moment& to, std::uint64_t tick, double time) {
    return !to.given || (to.seconds >= 0 ? time <= to.seconds : tick <= to.tick);
}

CsvCounts write_csv(const std::string& recording, const std::string& ticks, const std::string& exchanges,
                    const Moment& from, const Moment& to) {
    device::RecordingReader reader(recording.c_str());
    if (from.given) from.seconds >= 0 ? reader.seek_time(from.seconds) : reader.seek(from.tick > 0 ? from.tick - 1 : 0);
    Tables tables(ticks, exchanges, from, to);
    ProgressBar bar("csv");
    device::Event e;
    std::uint64_t read = 0;
    bool more = true;
    while (more && reader.next(e)) {
        more = tables.take(e);
        if (++read % 4096 == 0 && !bar.update(reader.share(), "")) throw Failure("interrupted; nothing was written");
    }
    tables.counts.torn = reader.torn();
    tables.commit();
    return tables.counts;
}

}  // namespace frm::cli
