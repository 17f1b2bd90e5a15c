// The one exception of the bake: its text is shown to the user, names the thing that is wrong and says what to do.
#pragma once

#include <stdexcept>
#include <string>

namespace frm::bake {

class BakeError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

}  // namespace frm::bake
