#include "tests/fuzz/quiet.h"

#include <spdlog/sinks/null_sink.h>
#include <spdlog/spdlog.h>

namespace vkopple::fuzz {
namespace {

constexpr const char* kLogger = "vkopple";

}  // namespace

Quiet::Quiet() { spdlog::null_logger_mt(kLogger); }
Quiet::~Quiet() { spdlog::drop(kLogger); }

}  // namespace vkopple::fuzz
