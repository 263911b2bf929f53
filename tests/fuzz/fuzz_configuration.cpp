// A scene file's text. Slashes are taken out, so that no elevation model outside the input can be named.
#include <algorithm>
#include <string>

#include "server/control/scene_file.h"
#include "terrain/base/errors.h"
#include "tests/fuzz/input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string text(reinterpret_cast<const char*>(data), size);
  std::replace(text.begin(), text.end(), '/', '_');
  try {
    const obliq::SceneConfig config = obliq::load_scene_text(text, "scene.toml");
    if (config.radars.empty()) obliq::fuzz::broken("a scene without a radar");
  } catch (const obliq::InputError& error) {
    if (*error.what() == '\0') obliq::fuzz::broken("refused without words");
  }
  return 0;
}
