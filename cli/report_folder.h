// The folder of a --report: a page and the data that it was drawn from.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace frm::cli {

/// What a report consists of.
struct ReportKind {
    std::vector<std::string> files;  ///< their names, the JSON first
    std::string format;              ///< a text in the JSON of every report of this kind
};

/// The folder, made under another name and given its own when all is in it. What is not finished is removed.
class ReportFolder {
public:
    /// To be made before the run: throws Failure if the folder cannot be written, or holds anything but an older report
    /// of this kind and `others`, files and folders that the same command writes.
    ReportFolder(const std::string& folder, ReportKind kind, const std::vector<std::string>& others);
    ~ReportFolder();
    ReportFolder(const ReportFolder&) = delete;
    ReportFolder& operator=(const ReportFolder&) = delete;

    /// Where the files are to be written.
    const std::filesystem::path& temporary() const { return temporary_; }
    /// Gives what was written its name. Of an older report's files those that there are no new ones of are removed.
    void publish();

    /// The paths of a report's files in `folder`.
    static std::vector<std::string> paths(const std::string& folder, const ReportKind& kind);

private:
    bool may_be_replaced(const std::vector<std::string>& others) const;

    ReportKind kind_;
    std::filesystem::path folder_, temporary_;
};

}  // namespace frm::cli
