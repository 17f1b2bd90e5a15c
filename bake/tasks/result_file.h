// One task's result in a file. Little-endian, compressed, checksummed; every byte is untrusted: the folder may lie on a
// shared disk, and a file there may be cut off, damaged or another bake's.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bake/tasks/task.h"

namespace frm::bake {

/// Everything that decides the bits of a task's result, hashed: the solver's version, the surface, the patches.
std::uint64_t hash_of_body(const Surface& surface, const Regions& patches);
/// The same with the case: the key under which a result is good.
std::uint64_t key_of(std::uint64_t body, const FlowCase& flow_case);

std::vector<std::uint8_t> encode_result(const TaskResult& result, std::uint64_t key);

/// Throws frm::Error saying what is wrong: damaged, of another version, or the result of something else (`key`,
/// `regions`).
TaskResult decode_result(const std::uint8_t* data, std::size_t size, std::uint64_t key, std::uint32_t regions);

}  // namespace frm::bake
