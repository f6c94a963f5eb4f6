/// \file
/// Shared by the larger programs: the version, options, and how they end.
#pragma once

#include <algorithm>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include <collide/core/version.hpp>

#include "error.hpp"

namespace io {

/// The version of the library.
inline std::string version() {
  return std::to_string(COLLIDE_VERSION_MAJOR) + '.' + std::to_string(COLLIDE_VERSION_MINOR) + '.' +
         std::to_string(COLLIDE_VERSION_PATCH);
}

/// Adds an option whose value is one of `names`.
inline void add_choice(CLI::App& app, char const* option, std::string& value, std::vector<std::string> const& names,
                       char const* about) {
  app.add_option(option, value, about)->check(CLI::IsMember(names))->type_name("NAME")->capture_default_str();
}

/// Parses the arguments, then calls `run`. Whatever goes wrong becomes one line on standard error and an exit
/// status: 2 for usage, 1 for data. `--help` and `--version` end with 0.
template <class Run>
int run_program(CLI::App& app, std::vector<std::string> args, Run const& run) {
  auto const fail = [&](int status, std::string const& what) {
    std::cerr << app.get_name() << ": " << one_line(what) << std::endl;
    return status;
  };
  app.set_version_flag("--version", app.get_name() + " (collide) " + version());
  try {
    std::reverse(args.begin(), args.end());  // as CLI11 takes them
    app.parse(std::move(args));
    run();
    if (!std::cout.flush()) throw data_error("standard output", "cannot be written");
    return 0;
  } catch (CLI::Success const& wish) {  // --help, --version
    return app.exit(wish);
  } catch (CLI::ParseError const& error) {
    return fail(2, std::string(error.what()) + " (see --help)");
  } catch (usage_error const& error) {
    return fail(2, std::string(error.what()) + " (see --help)");
  } catch (std::bad_alloc const&) {
    return fail(1, "not enough memory");
  } catch (std::exception const& error) {
    return fail(1, error.what());
  }
}

}  // namespace io
