#include "soapfilm/io/npy/npy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "soapfilm/core/printable.h"
#include "soapfilm/error.h"
#include "soapfilm/io/grid_view.h"
#include "soapfilm/io/npy/npy_header.h"
#include "soapfilm/io/range_image.h"
#include "soapfilm/io/text/text.h"
#include "soapfilm/io/unnamed_columns.h"

namespace soapfilm::io {

namespace {

class NpyReader {
 public:
  NpyReader(ByteSource& source, PointSink& sink, ReadReport& report, const Context& context)
      : source_(source), report_(report), context_(context), header_(read_npy_header(source)), stream_(sink) {}

  void read(const std::vector<std::string>& attributes) {
    if (header_.has_names)
      use_names();
    else
      use_columns();
    const bool judged = !header_.has_names && fields_.size() > 3;
    if (is_image_ || judged || has_cells()) stream_.keep_whole();
    PointTraits traits = read_rows(judged || has_cells() ? std::vector<std::string>{"all"} : attributes);
    PointCloud& cloud = stream_.samples();
    const PointColumns columns = meaning();
    warn_of_color_parts(columns, source_.path(), report_.warnings);
    if (judged) judge(cloud);
    PointEnd end;
    end.scans.emplace_back();
    Scan& scan = end.scans[0];
    scan.name = std::filesystem::path(source_.path()).stem().string();
    scan.end = stream_.size();
    const bool has_grid = is_image_ && header_.shape[0] > 1 && header_.shape[1] > 1;
    if (has_grid) {
      scan.range_grid =
          full_grid(static_cast<int>(header_.shape[1]), static_cast<int>(header_.shape[0]), header_.fortran_order);
      if (is_scanner_place(cloud.positions, scan, {}, false)) scan.sensor = Vec3d{};
    }

    FileReport file;
    file.path = source_.path();
    file.format = fmt::format("NumPy array {}", describe_shape(header_.shape));
    for (const BinaryField& field : fields_) file.properties.push_back(field.name);
    traits.float32 = std::all_of(columns.position.index.begin(), columns.position.index.end(),
                                 [&](size_t k) { return fields_[k].type == NumberType::float32; });
    traits.zero_is_none = traits.nan_is_none = is_image_;
    stream_.finish(std::move(end), std::move(file), traits, report_);
    if (stream_.is_whole()) {
      if (const std::string why = give_named_grid(cloud); !why.empty())
        warn("rows and columns not used as a range grid: " + why);
      keep_attributes(attributes, cloud);
    }
    stream_.close();
  }

 private:
  void warn(const std::string& message) { report_.warnings.push_back(source_.path() + ": " + message); }

  [[noreturn]] void fail(const std::string& message) const { throw InputError(source_.path() + ": " + message); }

  PointColumns meaning() const {
    std::vector<std::string> names;
    for (const BinaryField& field : fields_) names.push_back(field.name);
    return meaning_of(names);
  }

  void check_size(uint64_t rows, size_t row_bytes) {
    const size_t left = source_.bytes().size() - header_.data;
    if (rows == 0) fail(fmt::format("shape = {}: holds no samples", describe_shape(header_.shape)));
    if (rows > left / row_bytes)
      fail(fmt::format("byte {}: shape = {} of {} bytes each row, must be at most {} rows: the file is truncated",
                       header_.data, describe_shape(header_.shape), row_bytes, left / row_bytes));
    rows_ = static_cast<size_t>(rows);
    if (left > rows_ * row_bytes) warn(fmt::format("{} bytes after the array are not read", left - rows_ * row_bytes));
  }

  bool are_sizes_of_image() const { return header_.shape[0] <= INT32_MAX && header_.shape[1] <= INT32_MAX; }

  /// One element with fields for each sample, or for each cell of a range image.
  void use_names() {
    const std::vector<uint64_t>& shape = header_.shape;
    is_image_ = shape.size() == 2;
    if ((shape.size() != 1 && !is_image_) || (is_image_ && !are_sizes_of_image()))
      fail(fmt::format("shape = {}, must be (n,) or (height, width) of elements with named fields",
                       describe_shape(shape)));
    check_size(is_image_ ? shape[0] * shape[1] : shape[0], header_.element_bytes);
    fields_ = header_.fields;
    for (BinaryField& field : fields_) {
      field.name = printable(std::move(field.name));  // it reaches reports and files
      field.offset += header_.data;
      field.stride = header_.element_bytes;
    }
    if (!meaning().position.present()) {
      std::string names;
      for (const BinaryField& field : fields_)
        if (names.size() < 200) names += (names.empty() ? "" : ", ") + in_quotes(field.name);
      fail(fmt::format("has the fields {}, must have x, y and z among them", names.empty() ? "(none)" : names));
    }
    std::string unread;
    for (const std::string& name : header_.unread)
      if (unread.size() < 200) unread += (unread.empty() ? "" : ", ") + in_quotes(name);
    if (!unread.empty()) warn(fmt::format("fields that are no numbers of 1 to 8 bytes are not read: {}", unread));
  }

  /// One row of numbers for each sample, or for each cell of a range image.
  void use_columns() {
    constexpr std::string_view expected =
        "must be (n, 3), (n, 4), (n, 6) or more columns, or (height, width, 3) or more: x y z and further ones";
    constexpr uint64_t most_columns = 1000;
    const std::vector<uint64_t>& shape = header_.shape;
    is_image_ = shape.size() == 3;
    if ((shape.size() != 2 && !is_image_) || shape.back() < 3 || shape.back() > most_columns ||
        (is_image_ && !are_sizes_of_image())) {
      const bool is_turned = shape.size() == 2 && shape[0] >= 3 && shape[0] <= 10;
      fail(fmt::format("shape = {}, {}{}", describe_shape(shape), expected,
                       is_turned ? " (save the transposed array)" : ""));
    }
    const auto columns = static_cast<size_t>(shape.back());
    check_size(is_image_ ? shape[0] * shape[1] : shape[0], columns * header_.element_bytes);
    for (size_t k = 0; k < columns; ++k) {
      BinaryField field = header_.fields.at(0);
      field.stride = header_.fortran_order ? header_.element_bytes : columns * header_.element_bytes;
      field.offset = header_.data + k * header_.element_bytes * (header_.fortran_order ? rows_ : 1);
      fields_.push_back(std::move(field));
    }
    for (size_t k = 0; k < columns; ++k)
      fields_[k].name = k < 3 ? std::string(1, "xyz"[k]) : fmt::format("column_{}", k + 1);
  }

  /// What the columns behind the third are, once all of them have been read.
  void judge(PointCloud& cloud) {
    UnnamedColumns unnamed;
    unnamed.can_be_named = false;
    for (const BinaryField& field : fields_) unnamed.names.push_back(field.name);
    const auto is_fraction = [](const Vec3d& p) { return p.x != std::floor(p.x); };
    if (std::none_of(cloud.positions.begin(), cloud.positions.end(), is_fraction)) {
      unnamed.fourth.resize(rows_);
      read_field(source_.bytes(), fields_[3], 0, rows_, unnamed.fourth.data());
      if (fields_.size() > 4) {
        unnamed.fifth.resize(rows_);
        read_field(source_.bytes(), fields_[4], 0, rows_, unnamed.fifth.data());
      }
    }
    judge_unnamed_columns(cloud, unnamed);
    for (size_t k = 0; k < fields_.size(); ++k) fields_[k].name = unnamed.names[k];
    for (const std::string& remark : unnamed.remarks) warn(remark);
  }

  /// Do columns say where in a range grid each sample is?
  bool has_cells() const {
    std::vector<std::string> names;
    for (const BinaryField& field : fields_) names.push_back(column_name(field.name));
    return name_cells(names);
  }

  PointTraits read_rows(const std::vector<std::string>& attributes) {
    std::vector<std::string> names;
    for (const BinaryField& field : fields_) names.push_back(field.name);
    PointColumns kept = meaning();
    keep_attributes(attributes, names, kept);
    FieldReader reader(source_, fields_, std::move(kept));
    stream_.begin(reader.header(rows_), source_.path());
    const bool in_order = header_.has_names || !header_.fortran_order;
    for (size_t first = 0; first < rows_; first += FieldReader::block_rows) {
      context_.check();
      if (in_order) source_.release_before(header_.data + first * fields_[0].stride);
      reader.append(first, std::min(FieldReader::block_rows, rows_ - first), nullptr, stream_);
      stream_.pass();
    }
    return reader.traits();
  }

  ByteSource& source_;
  ReadReport& report_;
  const Context& context_;
  NpyHeader header_;
  std::vector<BinaryField> fields_;
  size_t rows_ = 0;
  PointStream stream_;
  bool is_image_ = false;  // the first two sizes are those of a range image
};

}  // namespace

bool looks_like_npy(const ByteSource& source) { return source.begins_with("\x93NUMPY"); }

void read_npy(ByteSource& source, PointSink& sink, ReadReport& report, const ReadOptions& options,
              const Context& context) {
  NpyReader(source, sink, report, context).read(options.attributes);
}

}  // namespace soapfilm::io
