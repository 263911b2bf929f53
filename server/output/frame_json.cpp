#include "server/output/frame_json.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "proto/bin_window.h"
#include "proto/obliq.pb.h"
#include "server/output/describe_frame.h"

namespace obliq {
namespace {

using Json = nlohmann::ordered_json;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

Json number(double value) {
  if (std::isfinite(value)) return value;
  if (std::isnan(value)) return "nan";
  return value > 0 ? "inf" : "-inf";
}

Json from_message(const Message& message) {
  Json object = Json::object();
  const Reflection& reflection = *message.GetReflection();
  for (int i = 0; i < message.GetDescriptor()->field_count(); ++i) {
    const FieldDescriptor* field = message.GetDescriptor()->field(i);
    if (field->is_repeated()) {
      Json list = Json::array();
      for (int k = 0; k < reflection.FieldSize(message, field); ++k) {
        if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE)
          list.push_back(from_message(reflection.GetRepeatedMessage(message, field, k)));
        else
          list.push_back(reflection.GetRepeatedString(message, field, k));
      }
      object[field->name()] = std::move(list);
      continue;
    }
    switch (field->cpp_type()) {
      case FieldDescriptor::CPPTYPE_MESSAGE:
        object[field->name()] = from_message(reflection.GetMessage(message, field));
        break;
      case FieldDescriptor::CPPTYPE_STRING:
        object[field->name()] = reflection.GetString(message, field);
        break;
      case FieldDescriptor::CPPTYPE_DOUBLE:
        object[field->name()] = number(reflection.GetDouble(message, field));
        break;
      case FieldDescriptor::CPPTYPE_BOOL:
        object[field->name()] = reflection.GetBool(message, field);
        break;
      case FieldDescriptor::CPPTYPE_INT32:
        object[field->name()] = reflection.GetInt32(message, field);
        break;
      case FieldDescriptor::CPPTYPE_INT64:
        object[field->name()] = reflection.GetInt64(message, field);
        break;
      case FieldDescriptor::CPPTYPE_UINT32:
        object[field->name()] = reflection.GetUInt32(message, field);
        break;
      case FieldDescriptor::CPPTYPE_UINT64:
        object[field->name()] = reflection.GetUInt64(message, field);
        break;
      case FieldDescriptor::CPPTYPE_ENUM:
        object[field->name()] = enum_word(reflection.GetEnum(message, field)->name());
        break;
      case FieldDescriptor::CPPTYPE_FLOAT:
        object[field->name()] = number(static_cast<double>(reflection.GetFloat(message, field)));
        break;
    }
  }
  return object;
}

/// Puts in the edges of a run of bins: n + 1 where they touch; where only every few are kept, the two edges
/// of each.
void put_edges(Json& root, const std::string& axis, const std::string& unit, const wire::BinRun& run,
               double start, double width) {
  Json list = Json::array();
  for (std::uint32_t k = 0; k < run.kept(); ++k) {
    const std::uint32_t bin = run.first + k * run.step;
    if (run.step == 1) {
      list.push_back(start + bin * width);
    } else {
      list.push_back({start + bin * width, start + (bin + 1) * width});
    }
  }
  if (run.step == 1) list.push_back(start + static_cast<double>(run.end()) * width);
  root[axis + (run.step == 1 ? "_edges_" : "_intervals_") + unit] = std::move(list);
}

}  // namespace

std::string enum_word(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  for (const std::string_view suffix : {"_speckle", "_plates"})
    if (text.ends_with(suffix)) text.resize(text.size() - suffix.size());
  return text;
}

std::string message_json(const Message& message) { return from_message(message).dump(); }

std::string frame_json(const wire::FrameDescriptor& descriptor, const wire::FrameSummary& summary) {
  Json root;
  root["frame"] = from_message(descriptor);
  root["summary"] = from_message(summary);
  // A live server numbers its frames; the files of a frame do not depend on how many came before.
  root["frame"].erase("frame_id");
  root["frame"].erase("settings_version");
  root["summary"].erase("frame_id");
  root["frame"]["warnings"] = frame_warnings(descriptor, summary);  // all that the programs print
  root["bin_states"] = {{"0", "not sampled"},
                        {"1", "sampled"},
                        {"2", "shadow"},
                        {"3", "no known surface"},
                        {"4", "no ground at this range"}};
  if (!descriptor.has_window()) root["frame"].erase("window");
  const auto window =
      wire::cut_window(wire::read_window(descriptor.window()),
                       static_cast<std::uint32_t>(std::max(0, descriptor.settings().azimuth_bins())),
                       static_cast<std::uint32_t>(std::max(0, descriptor.settings().range_bins())))
          .value_or(wire::Window{});
  put_edges(root, "azimuth", "deg", window.azimuth, descriptor.azimuth_start_deg(),
            descriptor.azimuth_width_deg());
  put_edges(root, "range", "m", window.range, descriptor.range_start_m(), descriptor.range_spacing_m());
  return root.dump(1) + "\n";
}

}  // namespace obliq
