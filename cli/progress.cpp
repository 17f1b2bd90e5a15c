#include "cli/progress.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>

namespace frm::cli {
namespace {

volatile std::sig_atomic_t stop = 0;

void note_interrupt(int) { stop = 1; }

/// Sets the handler unless the signal is ignored (nohup, a job in the background). Gives the one there was.
void (*watch(int number))(int) {
    void (*const old)(int) = std::signal(number, note_interrupt);
    if (old == SIG_IGN) std::signal(number, SIG_IGN);
    return old;
}

std::string time_text(double seconds) {
    char text[32];
    if (seconds < 90)
        std::snprintf(text, sizeof text, "%.0f s", seconds);
    else if (seconds < 5400)
        std::snprintf(text, sizeof text, "%.0f min", seconds / 60);
    else
        std::snprintf(text, sizeof text, "%.1f h", seconds / 3600);
    return text;
}

/// Columns of the terminal: a line that is longer would wrap, and could not be overwritten.
std::size_t columns() {
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20 ? size.ws_col : 80;
}

double seconds_between(std::chrono::steady_clock::time_point a, std::chrono::steady_clock::time_point b) {
    return std::chrono::duration<double>(b - a).count();
}

}  // namespace

bool interrupted() { return stop != 0; }

ProgressBar::ProgressBar(std::string title)
    : title_(std::move(title)),
      begin_(Clock::now()),
      shown_(begin_),
      terminal_(isatty(STDERR_FILENO) != 0),
      old_interrupt_(watch(SIGINT)),
      old_terminate_(watch(SIGTERM)),
      old_hang_up_(watch(SIGHUP)) {}

void print_note(const std::string& text) {
    std::fprintf(stderr, "%snote: %s\n", isatty(STDERR_FILENO) ? "\r\033[K" : "", text.c_str());
}

void ProgressBar::hide() {
    if (visible_ && terminal_) std::fprintf(stderr, "\r\033[K");
    std::fflush(stderr);
    visible_ = false;
}

ProgressBar::~ProgressBar() {
    hide();
    std::signal(SIGINT, old_interrupt_);
    std::signal(SIGTERM, old_terminate_);
    std::signal(SIGHUP, old_hang_up_);
}

double ProgressBar::elapsed() const { return seconds_between(begin_, Clock::now()); }

bool ProgressBar::update(double share, const std::string& note) {
    return update(share, share > 0 ? elapsed() * (1 - share) / share : -1, note);
}

bool ProgressBar::update(double share, double seconds_left, const std::string& note) {
    const Clock::time_point now = Clock::now();
    const double pause = terminal_ ? 0.1 : std::max(5.0, elapsed() / 20);
    if (elapsed() < 2 || (visible_ && seconds_between(shown_, now) < pause)) return !interrupted();
    visible_ = true;
    shown_ = now;
    share = std::clamp(share, 0.0, 1.0);
    const std::string left = seconds_left >= 0 ? time_text(seconds_left) + " left" : "";
    if (terminal_) {
        const std::size_t across = columns(), width = across < 100 ? 6 : 20;
        const auto full = static_cast<std::size_t>(share * static_cast<double>(width));
        char percent[16];
        std::snprintf(percent, sizeof percent, " %3.0f %%", 100 * share);
        std::string line = title_ + " [" + std::string(full, '#') + std::string(width - full, '.') + "]" + percent;
        for (const std::string& text : {left, note})
            if (!text.empty()) line += "  " + text;
        std::fprintf(stderr, "\r\033[K%s", line.substr(0, across - 1).c_str());
    } else {
        std::fprintf(stderr, "%s: %3.0f %%", title_.c_str(), 100 * share);
        for (const std::string& text : {left, note})
            if (!text.empty()) std::fprintf(stderr, ", %s", text.c_str());
        std::fputc('\n', stderr);
    }
    std::fflush(stderr);
    return !interrupted();
}

}  // namespace frm::cli
