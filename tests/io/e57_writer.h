// Writes E57 files of every coding, for tests only: it shares no code with the reader.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <functional>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace soapfilm::test {

/// A field of the records. Numbers are those of the file: integers before scale and offset.
struct E57TestField {
  std::string name;  ///< with a prefix, if it should have one
  std::string type;  ///< Float32, Float64, Integer, ScaledInteger or String
  std::vector<double> floats{};
  std::vector<int64_t> integers{};
  std::optional<int64_t> minimum{}, maximum{};
  std::string more{};  ///< further attributes, such as scale="0.1"
};

inline E57TestField floats(const std::string& name, std::vector<double> values, const std::string& more = {}) {
  return {name, "Float32", std::move(values), {}, {}, {}, more};
}
inline E57TestField doubles(const std::string& name, std::vector<double> values) {
  return {name, "Float64", std::move(values), {}, {}, {}, {}};
}
inline E57TestField integers(const std::string& name, std::vector<int64_t> values, std::optional<int64_t> minimum,
                             std::optional<int64_t> maximum, const std::string& more = {}) {
  return {name, more.empty() ? "Integer" : "ScaledInteger", {}, std::move(values), minimum, maximum, more};
}

struct E57TestScan {
  std::vector<E57TestField> fields;
  std::string xml{};                      ///< further children of the scan, such as its pose
  std::optional<int64_t> record_count{};  ///< else as many as the first field has
};

struct E57TestOptions {
  std::string root_xml{};
  std::string prefix{};  ///< of all elements, with the colon
  /// Bytes of stream k in packet p, at most; else all in one packet.
  std::function<size_t(size_t packet, size_t stream)> split{};
  bool other_packets = false;  ///< index and empty packets between those with data
};

class E57Writer {
 public:
  static std::string file(const std::vector<E57TestScan>& scans, const E57TestOptions& options = {}) {
    E57Writer writer(options);
    for (const E57TestScan& scan : scans) writer.add(scan);
    return writer.finish();
  }

  /// The file of pages with these bytes, whose header it completes; `xml_length` bytes of XML are at the end.
  static std::string paged(std::string logical, size_t xml_length) {
    const size_t xml_at = logical.size() - xml_length;
    logical.resize((logical.size() + 1019) / 1020 * 1020, ' ');
    const uint64_t length = logical.size() / 1020 * 1024;
    logical.replace(0, 48,
                    "ASTM-E57" + bytes_of(uint32_t{1}) + bytes_of(uint32_t{0}) + bytes_of(length) +
                        bytes_of(uint64_t{physical(xml_at)}) + bytes_of(uint64_t{xml_length}) +
                        bytes_of(uint64_t{1024}));
    std::string file;
    for (size_t at = 0; at < logical.size(); at += 1020) file += logical.substr(at, 1020) + checksum(logical, at);
    return file;
  }

  /// Four bytes for the page that begins at `at`.
  static std::string checksum(const std::string& bytes, size_t at) {
    uint32_t crc = 0xffffffff;
    for (size_t i = at; i < at + 1020; ++i) {
      crc ^= static_cast<uint8_t>(bytes[i]);
      for (int k = 0; k < 8; ++k) crc = crc >> 1 ^ (crc & 1 ? 0x82f63b78 : 0);
    }
    std::string big_endian;
    for (int shift = 24; shift >= 0; shift -= 8) big_endian += static_cast<char>(~crc >> shift & 0xff);
    return big_endian;
  }
  /// The file with right checksums, after its bytes were changed.
  static std::string repaired(std::string file) {
    for (size_t at = 0; at + 1024 <= file.size(); at += 1024) file.replace(at + 1020, 4, checksum(file, at));
    return file;
  }

  template <class T>
  static std::string bytes_of(T value) {
    std::string bytes;
    for (size_t k = 0; k < sizeof(T); ++k) bytes += static_cast<char>(static_cast<uint64_t>(value) >> 8 * k & 0xff);
    return bytes;
  }
  static size_t physical(size_t logical) { return logical / 1020 * 1024 + logical % 1020; }

 private:
  explicit E57Writer(const E57TestOptions& options) : options_(options), logical_(48, '\0') {}

  static size_t count(const E57TestField& f) { return std::max(f.floats.size(), f.integers.size()); }

  static std::string stream(const E57TestField& f) {
    std::string bytes;
    if (f.type == "String") {
      for (size_t i = 0; i < count(f); ++i) bytes += std::string(1, '\x06') + "abc";
      return bytes;
    }
    for (const double v : f.floats)
      bytes += f.type == "Float32" ? bytes_of(std::bit_cast<uint32_t>(static_cast<float>(v)))
                                   : bytes_of(std::bit_cast<uint64_t>(v));
    const uint64_t least = static_cast<uint64_t>(f.minimum.value_or(INT64_MIN));
    const uint64_t span = static_cast<uint64_t>(f.maximum.value_or(INT64_MAX)) - least;
    const auto width = static_cast<int>(std::bit_width(span));
    int used = 8;
    for (const int64_t v : f.integers)
      for (int k = 0; k < width; ++k, ++used) {
        if (used == 8) bytes += '\0', used = 0;
        const uint64_t bit = (static_cast<uint64_t>(v) - least) >> k & 1;
        bytes.back() = static_cast<char>(static_cast<uint8_t>(bytes.back()) | bit << used);
      }
    return bytes;
  }

  std::string element(const std::string& name, const std::string& attributes, const std::string& content) const {
    return "<" + options_.prefix + name + " " + attributes + ">" + content + "</" + options_.prefix + name + ">\n";
  }

  void add(const E57TestScan& scan) {
    const size_t section = logical_.size();
    std::vector<std::string> streams;
    for (const E57TestField& field : scan.fields) streams.push_back(stream(field));
    const std::string packets = in_packets(streams);
    logical_ += std::string("\1\0\0\0\0\0\0\0", 8) + bytes_of(uint64_t{32 + packets.size()}) +
                bytes_of(uint64_t{physical(section + 32)}) + bytes_of(uint64_t{0}) + packets;
    std::string prototype;
    for (const E57TestField& f : scan.fields) {
      const bool is_float = f.type.substr(0, 5) == "Float";
      std::string attributes = is_float ? "type=\"Float\"" : "type=\"" + f.type + "\"";
      if (f.type == "Float32") attributes += " precision=\"single\"";
      if (f.minimum) attributes += " minimum=\"" + std::to_string(*f.minimum) + "\"";
      if (f.maximum) attributes += " maximum=\"" + std::to_string(*f.maximum) + "\"";
      prototype += "<" + f.name + " " + attributes + " " + f.more + "/>\n";
    }
    const int64_t records = scan.record_count.value_or(static_cast<int64_t>(count(scan.fields.at(0))));
    scans_ += element("vectorChild", "type=\"Structure\"",
                      scan.xml + element("points",
                                         "type=\"CompressedVector\" fileOffset=\"" + std::to_string(physical(section)) +
                                             "\" recordCount=\"" + std::to_string(records) + "\"",
                                         element("prototype", "type=\"Structure\"", prototype) +
                                             element("codecs", "type=\"Vector\"", "")));
  }

  std::string in_packets(const std::vector<std::string>& streams) const {
    std::string packets;
    std::vector<size_t> taken(streams.size());
    bool more = true;
    for (size_t p = 0; more; ++p) {
      if (options_.other_packets) {
        packets += std::string("\2\0", 2) + bytes_of(uint16_t{7}) + "junk";
        packets += std::string("\0\0", 2) + bytes_of(uint16_t{15 + 16}) + std::string(28, 'i');
      }
      std::string lengths, data;
      more = false;
      for (size_t k = 0; k < streams.size(); ++k) {
        const size_t most = options_.split ? options_.split(p, k) : size_t{60000} / streams.size();
        const size_t now = std::min(most, streams[k].size() - taken[k]);
        data += streams[k].substr(taken[k], now);
        taken[k] += now;
        lengths += bytes_of(static_cast<uint16_t>(now));
        more = more || taken[k] < streams[k].size();
      }
      std::string body = bytes_of(static_cast<uint16_t>(streams.size())) + lengths + data;
      body.resize((body.size() + 4 + 3) / 4 * 4 - 4, '\0');
      packets += std::string("\1\0", 2) + bytes_of(static_cast<uint16_t>(body.size() + 3)) + body;
    }
    return packets;
  }

  std::string finish() {
    const std::string space =
        options_.prefix.empty() ? "xmlns" : "xmlns:" + options_.prefix.substr(0, options_.prefix.size() - 1);
    const std::string xml =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" +
        element("e57Root",
                "type=\"Structure\" " + space +
                    "=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\" xmlns:nor=\"http://www.libe57.org/nor\"",
                element("formatName", "type=\"String\"", "<![CDATA[ASTM E57 3D Imaging Data File]]>") +
                    options_.root_xml + element("data3D", "type=\"Vector\"", scans_) +
                    element("images2D", "type=\"Vector\"", ""));
    return paged(logical_ + xml, xml.size());
  }

  const E57TestOptions& options_;
  std::string logical_;
  std::string scans_;
};

/// x = 1, 2, 3, ..., y and z constant.
inline E57TestScan line_scan(size_t count, const std::vector<E57TestField>& further = {}, const std::string& xml = {}) {
  std::vector<double> x, y(count, 2), z(count, 3);
  for (size_t i = 0; i < count; ++i) x.push_back(static_cast<double>(i + 1));
  E57TestScan scan{{floats("cartesianX", x), floats("cartesianY", y), floats("cartesianZ", z)}, xml};
  scan.fields.insert(scan.fields.end(), further.begin(), further.end());
  return scan;
}

inline std::string pose_xml(const std::string& rotation, const std::string& translation) {
  const auto part = [](const std::string& name, const std::string& values, std::string names) {
    std::istringstream in(values);
    std::string xml, value;
    for (const char c : names)
      if (in >> value) xml += std::string("<") + c + " type=\"Float\">" + value + "</" + c + ">";
    return values.empty() ? std::string() : "<" + name + " type=\"Structure\">" + xml + "</" + name + ">";
  };
  return "<pose type=\"Structure\">" + part("rotation", rotation, "wxyz") + part("translation", translation, "xyz") +
         "</pose>";
}

}  // namespace soapfilm::test
