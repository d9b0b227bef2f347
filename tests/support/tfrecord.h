#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "example.pb.h"

namespace vkopple::test {

/// A record as it stands in a plain file: length, check, bytes, check.
std::string framed(const std::string& record);

/// What gzip makes of it.
std::string gzipped(const std::string& bytes);

/// A TFRecord file of these examples.
void write_examples(const std::filesystem::path& path, const std::vector<records::Example>& examples,
                    bool gzip = false);

// Features by name.
void set_bytes(records::Example& example, const std::string& name, const std::vector<std::string>& values);
void set_floats(records::Example& example, const std::string& name, const std::vector<float>& values);
void set_integers(records::Example& example, const std::string& name, const std::vector<std::int64_t>& values);

}  // namespace vkopple::test
