#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

/// Records of MCAP as https://mcap.dev/spec describes them, put together independently of the
/// tested code.
namespace splinecast::testing {

template <typename T>
std::string number(T value) {
  std::string bytes;
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    bytes.push_back(static_cast<char>((static_cast<std::uint64_t>(value) >> (8 * i)) & 0xFFU));
  }
  return bytes;
}
inline std::string u16(std::uint16_t value) { return number(value); }
inline std::string u32(std::size_t value) { return number(static_cast<std::uint32_t>(value)); }
inline std::string u64(std::uint64_t value) { return number(value); }
inline std::string text(const std::string& value) { return u32(value.size()) + value; }

inline std::string record(char opcode, const std::string& content) {
  return opcode + u64(content.size()) + content;
}

/// CRC-32, bit by bit.
inline std::uint32_t crc32(const std::string& bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const char byte : bytes) {
    crc ^= static_cast<unsigned char>(byte);
    for (int i = 0; i < 8; ++i) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xEDB88320U : 0U);
  }
  return ~crc;
}

inline const std::string kMagicText = "\x89MCAP0\r\n";

}  // namespace splinecast::testing
