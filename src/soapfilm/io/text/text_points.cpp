#include "soapfilm/io/text/text_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "soapfilm/core/memory.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io/point_columns.h"
#include "soapfilm/io/point_table.h"
#include "soapfilm/io/range_image.h"
#include "soapfilm/io/text/text.h"
#include "soapfilm/io/text/text_encoding.h"
#include "soapfilm/io/text/text_head.h"
#include "soapfilm/io/text/text_rows.h"
#include "soapfilm/io/unnamed_columns.h"

namespace soapfilm::io {

namespace {

/// How much text is read at once: enough to keep some threads busy, and little relative to the cloud.
constexpr size_t text_chunk_bytes = size_t{1} << 17, most_text_chunks = 16;

/// The names in ReadOptions::columns.
std::vector<std::string> names_of_option(const std::string& list) {
  std::vector<std::string> names, seen;
  for (size_t begin = 0; begin <= list.size();) {
    const size_t end = std::min(list.find(',', begin), list.size());
    std::string name = column_name(list.substr(begin, end - begin));
    names.push_back(name.empty() ? "-" : std::move(name));
    begin = end + 1;
  }
  for (const std::string& name : names) {
    const std::string lower = lower_case(name);
    if (name != "-" && std::find(seen.begin(), seen.end(), lower) != seen.end())
      throw ParameterError(fmt::format("columns = {}: {} is there twice, must be once", list, in_quotes(name)));
    seen.push_back(lower);
  }
  if (!meaning_of(names).position.present())
    throw ParameterError(fmt::format("columns = {}, must name x, y and z, such as x,y,z,-,nx,ny,nz", list));
  return names;
}

/// Names that an extension gives to so many columns; none: values must tell.
std::vector<std::string> names_of_extension(const std::string& path, size_t columns) {
  const std::string extension = lower_case(std::filesystem::path(path).extension().string());
  if (columns == 6 && (extension == ".xyzn" || extension == ".npts" || extension == ".pwn"))
    return {"x", "y", "z", "nx", "ny", "nz"};
  if (columns == 6 && extension == ".xyzrgb") return {"x", "y", "z", "red", "green", "blue"};
  return {};
}

template <class T>
void append_triples(const RowChunk& chunk, size_t columns, const Triple& triple, std::vector<Vec3<T>>& all) {
  if (!triple.present()) return;
  const double* row = chunk.values.data();
  for (size_t i = 0; i < chunk.rows; ++i, row += columns)
    all.push_back({static_cast<T>(row[triple[0]]), static_cast<T>(row[triple[1]]), static_cast<T>(row[triple[2]])});
}

void append_values(const RowChunk& chunk, size_t columns, size_t column, std::vector<float>& all) {
  for (size_t i = 0; i < chunk.rows; ++i) all.push_back(static_cast<float>(chunk.values[i * columns + column]));
}

class TextReader {
 public:
  TextReader(ByteSource& source, PointSink& sink, const ReadOptions& options, const Context& context)
      : path_(source.path()), context_(context), text_(source), attributes_(options.attributes), stream_(sink) {
    if (!options.columns.empty()) names_ = names_of_option(options.columns);
  }

  void read(ReadReport& report) {
    head_ = read_text_head(text_.text(), names_.size(), path_);
    find_meaning();
    prepare();
    read_rows();
    close_scan(true);
    if (stream_.size() == 0) throw InputError(path_ + ": holds no samples");
    if (stream_.is_whole()) normals_after_positions();
    if (unnamed_) judge();
    drop_text_columns();
    warn_of_color_parts(columns_, path_, head_.warnings);
    FileReport file;
    file.path = path_;
    file.format = head_.decimal_commas ? "text, decimal commas" : "text";
    for (const std::string& name : names_) file.properties.push_back(column_name(name));
    std::move(head_.warnings.begin(), head_.warnings.end(), std::back_inserter(report.warnings));
    PointEnd end;
    end.scans = std::move(scans_);
    end.without = text_alone_;
    stream_.finish(std::move(end), std::move(file), {}, report);
    if (stream_.is_whole()) {
      if (const std::string why = give_named_grid(stream_.samples()); !why.empty())
        report.warnings.push_back(fmt::format("{}: rows and columns not used as a range grid: {}", path_, why));
      keep_attributes(attributes_, stream_.samples());
    }
    stream_.close();
  }

 private:
  [[noreturn]] void fail(size_t line, const std::string& what) const {
    throw InputError(fmt::format("{}:{}: {}", path_, line, what));
  }

  /// What the columns are by the option, the header or the extension; or only how many there are.
  void find_meaning() {
    if (!names_.empty()) {
      if (names_.size() != head_.columns)
        fail(head_.line, fmt::format("{} columns, must be {} as --columns names", head_.columns, names_.size()));
      rules_.expected = "as --columns names";
    } else {
      rules_.expected = head_.names.empty() ? fmt::format("as in line {}", head_.line) : "as the header names";
      names_ = head_.names.empty() ? names_of_extension(path_, head_.columns) : head_.names;
    }
    if (names_.empty()) {
      names_ = {"x", "y", "z"};
      for (size_t k = 4; k <= head_.columns; ++k) names_.push_back(fmt::format("column_{}", k));
      if (names_.size() > 3) unnamed_.emplace();
    }
    columns_ = meaning_of(names_);
    std::erase_if(columns_.others, [&](size_t k) { return names_[k] == "-"; });
    // What only all rows tell: what columns are, where in a grid, or that the second half are normals.
    const bool may_be_halves = is_pwn() && head_.count && names_.size() == 3;
    if (unnamed_ || may_be_halves || name_cells(names_))
      stream_.keep_whole();
    else
      keep_attributes(attributes_, names_, columns_);
    has_number_.assign(columns_.others.size(), false);
  }

  /// Rules for the rows, and a cloud with room for about as many as there will be.
  void prepare() {
    const bool all_numbers = unnamed_.has_value();
    rules_.separator = head_.separator;
    rules_.decimal_commas = head_.decimal_commas;
    rules_.header = head_.header;
    rules_.more_columns = head_.has_lists;
    rules_.weight = columns_.weight;
    rules_.fields.assign(names_.size(), FieldRule::skipped);
    for (const Triple& triple : {columns_.position, columns_.normal, columns_.sensor, columns_.color})
      if (triple.present())
        for (const size_t k : triple.index) rules_.fields[k] = FieldRule::number;
    if (columns_.weight != Triple::absent) rules_.fields[columns_.weight] = FieldRule::number;
    for (const size_t k : columns_.others) rules_.fields[k] = all_numbers ? FieldRule::number : FieldRule::any;

    const size_t bytes = text_.text().size() - head_.offset;
    const size_t rows = std::min({bytes / head_.row_bytes + bytes / head_.row_bytes / 50 + 1,
                                  bytes / (2 * head_.columns) + 1, static_cast<size_t>(INT32_MAX)});
    PointHeader header{rows,
                       columns_.normal.present(),
                       columns_.sensor.present(),
                       columns_.weight != Triple::absent,
                       columns_.color.present(),
                       {}};
    for (const size_t k : columns_.others) header.columns.push_back(names_[k]);
    header.colors_in_range_of_all = true;
    stream_.begin(header, path_);
    if (head_.count) begin_scan(*head_.count, head_.count_line);
  }

  /// Chunks of lines, read by all threads and appended in order.
  void read_rows() {
    const std::string_view text = text_.text();
    const size_t at_once = std::min(most_text_chunks, 2 * static_cast<size_t>(context_.threads()));
    std::vector<RowChunk> chunks(at_once);
    size_t line = head_.line;
    for (size_t begin = head_.offset; begin < text.size();) {
      context_.check();
      size_t count = 0;
      for (; begin < text.size() && count < at_once; begin = chunks[count++].end) {
        chunks[count].begin = begin;
        chunks[count].end = line_at(text, std::min(begin + text_chunk_bytes, text.size())).next;
      }
      parallel_for(context_, count, 1, [&](size_t k) { io::read_rows(text, rules_, chunks[k]); });
      for (size_t k = 0; k < count; ++k) line = append(chunks[k], line);
      text_.release_before(begin);
    }
  }

  /// Returns the number of the line after the chunk.
  size_t append(const RowChunk& chunk, size_t line) {
    const size_t columns = names_.size();
    const size_t before = stream_.size();
    PointCloud& cloud = stream_.samples();
    for (const CountLine& count : chunk.counts) begin_scan_at(before + count.row, count.count, line + count.line);
    if (chunk.error) fail(line + chunk.lines, *chunk.error);
    if (stream_.is_whole() && chunk.rows > most_cloud_samples - before)
      throw InputError(
          fmt::format("{}: holds more than {} samples, must be at most so many", path_, most_cloud_samples));
    append_triples(chunk, columns, columns_.position, cloud.positions);
    append_triples(chunk, columns, columns_.normal, cloud.normals);
    append_triples(chunk, columns, columns_.sensor, cloud.sensors);
    if (columns_.weight != Triple::absent) append_values(chunk, columns, columns_.weight, cloud.weights);
    if (const Triple& c = columns_.color; c.present())
      for (size_t i = 0; i < chunk.rows * columns; i += columns)
        stream_.colors().add(chunk.values[i + c[0]], chunk.values[i + c[1]], chunk.values[i + c[2]]);
    for (size_t k = 0; k < columns_.others.size(); ++k) append_further(chunk, k, cloud.columns[k].values);
    if (unnamed_) keep_coordinates(chunk, before);
    for (const TextFields& text : chunk.texts) add_text(text, line);
    stream_.pass();
    return line + chunk.lines;
  }

  void append_further(const RowChunk& chunk, size_t k, std::vector<float>& values) {
    append_values(chunk, names_.size(), columns_.others[k], values);
    if (!has_number_[k])
      has_number_[k] = std::any_of(values.end() - static_cast<std::ptrdiff_t>(chunk.rows), values.end(),
                                   [](float v) { return !std::isnan(v); });
  }

  /// As long as the first column is whole it may count rows or cells: then these are coordinates.
  void keep_coordinates(const RowChunk& chunk, size_t before) {
    if (unnamed_->fourth.size() != before) return;
    const std::vector<Vec3d>& positions = stream_.samples().positions;
    for (size_t i = before; i < positions.size(); ++i)
      if (const double x = positions[i].x; x != std::floor(x)) {
        release(unnamed_->fourth);
        return release(unnamed_->fifth);
      }
    const size_t columns = names_.size();
    for (size_t i = 0; i < chunk.rows * columns; i += columns) {
      unnamed_->fourth.push_back(chunk.values[i + 3]);
      if (columns > 4) unnamed_->fifth.push_back(chunk.values[i + 4]);
    }
  }

  void add_text(const TextFields& found, size_t line) {
    for (TextFields& text : texts_)
      if (text.column == found.column) {
        text.count += found.count;
        return;
      }
    texts_.push_back(found);
    texts_.back().line += line;
  }

  void begin_scan_at(size_t row, double count, size_t line) {
    if (!in_scan_ && row > 0) fail(line, "a count of samples after samples without one, must come first");
    if (in_scan_ && static_cast<double>(row - scans_.back().begin) != promised_)
      fail(line, fmt::format("{} samples, must be {} as the count in line {} says", row - scans_.back().begin,
                             promised_, promised_line_));
    end_of_scan_ = row;
    if (in_scan_) close_scan(false);
    begin_scan(count, line);
    scans_.back().begin = row;
  }

  void begin_scan(double count, size_t line) {
    in_scan_ = true;
    promised_ = count;
    promised_line_ = line;
    scans_.emplace_back();
  }

  void close_scan(bool last) {
    if (!in_scan_) scans_.emplace_back();
    Scan& scan = scans_.back();
    scan.end = last ? stream_.size() : end_of_scan_;
    scan.name = std::filesystem::path(path_).stem().string();
    if (last && in_scan_ && static_cast<double>(scan.size()) != promised_) {
      if (!is_count_of_halves())
        head_.warnings.push_back(fmt::format("{}:{}: count = {}, but {} samples follow: all of them are read", path_,
                                             promised_line_, promised_, scan.size()));
    }
    if (scan.size() == 0) scans_.pop_back();
  }

  /// A .pwn file of some programs: a count n, n positions, then n normals.
  bool is_count_of_halves() const {
    return is_pwn() && scans_.size() == 1 && names_.size() == 3 && static_cast<double>(stream_.size()) == 2 * promised_;
  }

  bool is_pwn() const { return lower_case(std::filesystem::path(path_).extension().string()) == ".pwn"; }

  void normals_after_positions() {
    if (!in_scan_ || !is_count_of_halves()) return;
    PointCloud& cloud = stream_.samples();
    const size_t count = cloud.size() / 2;
    size_t units = 0;
    cloud.normals.reserve(count);
    for (size_t i = count; i < 2 * count; ++i) {
      units += std::abs(norm(cloud.positions[i]) - 1) < 0.05;
      cloud.normals.push_back(static_cast<Vec3f>(cloud.positions[i]));
    }
    if (10 * units < 9 * count)
      fail(promised_line_, fmt::format("count = {}, but {} samples follow, must be as many, or {} positions and then "
                                       "as many normals of length 1",
                                       promised_, 2 * count, promised_));
    cloud.positions.resize(count);
    scans_[0].end = count;
    names_ = {"x", "y", "z", "nx", "ny", "nz"};
  }

  void judge() {
    unnamed_->names = std::move(names_);
    judge_unnamed_columns(stream_.samples(), *unnamed_);
    names_ = std::move(unnamed_->names);
    for (const std::string& remark : unnamed_->remarks) head_.warnings.push_back(path_ + ": " + remark);
  }

  /// A column of text alone is not kept; text among numbers is not-a-number.
  void drop_text_columns() {
    for (const TextFields& text : texts_) {
      const auto k = static_cast<size_t>(std::find(columns_.others.begin(), columns_.others.end(), text.column) -
                                         columns_.others.begin());
      if (!has_number_[k]) text_alone_.push_back(k);
      head_.warnings.push_back(fmt::format("{}:{}: column {} holds {}, no number, {}", path_, text.line,
                                           in_quotes(names_[text.column]), in_quotes(text.first),
                                           has_number_[k] ? fmt::format("in {} rows: without a value there", text.count)
                                                          : "and so do all rows: not used"));
    }
  }

  std::string path_;
  const Context& context_;
  PlainText text_;
  TextHead head_;
  RowRules rules_;
  std::vector<std::string> names_;
  PointColumns columns_;
  std::optional<UnnamedColumns> unnamed_;  // of columns that their values must tell
  std::vector<std::string> attributes_;
  PointStream stream_;
  std::vector<Scan> scans_;
  std::vector<bool> has_number_;    // of each of columns_.others
  std::vector<size_t> text_alone_;  // of columns_.others
  std::vector<TextFields> texts_;
  bool in_scan_ = false;      // a count line came
  double promised_ = 0;       // by the last of them
  size_t promised_line_ = 0;  // its number
  size_t end_of_scan_ = 0;    // where the next one came
};

}  // namespace

void read_text_points(ByteSource& source, PointSink& sink, ReadReport& report, const ReadOptions& options,
                      const Context& context) {
  TextReader(source, sink, options, context).read(report);
}

}  // namespace soapfilm::io
