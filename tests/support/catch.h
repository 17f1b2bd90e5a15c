// Catch2 v2 (Debian 12, Ubuntu 22.04) and v3 (later) have other header names; tests include this.
#pragma once

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
using Catch::Approx;
#else
#include <catch2/catch.hpp>
#endif
