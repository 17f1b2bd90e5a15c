// How far a long command is, on standard error: a bar with the time left on a terminal, a plain line now
// and then elsewhere.
#pragma once

#include <chrono>
#include <string>

namespace frm::cli {

class ProgressBar {
public:
    explicit ProgressBar(std::string title);
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    /// `share` is 0 to 1. Shows nothing during the first two seconds. False once the user has pressed Ctrl-C.
    bool update(double share, const std::string& note);
    /// The same for work that knows its time: `seconds_left` below zero says that it does not yet.
    bool update(double share, double seconds_left, const std::string& note);
    /// Takes the bar off the terminal; the next update() shows it again. Signals are held back all the same.
    void hide();

private:
    using Clock = std::chrono::steady_clock;

    /// Seconds since the start.
    double elapsed() const;

    std::string title_;
    Clock::time_point begin_, shown_;
    bool terminal_, visible_ = false;
    void (*old_interrupt_)(int);
    void (*old_terminate_)(int);
    void (*old_hang_up_)(int);
};

/// A line "note: ..." on standard error, also where a bar is shown.
void print_note(const std::string& text);

/// True once the user has pressed Ctrl-C, or the system asked for an end (SIGTERM; SIGHUP, of a
/// terminal that was closed), while there was a ProgressBar.
bool interrupted();

}  // namespace frm::cli
