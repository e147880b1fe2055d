// SPDX-License-Identifier: BSD-3-Clause
#include "frontends/host/plugins.hpp"

#include <dlfcn.h>

#include "frontends/laser/laser_frontend.hpp"
#include "frontends/laser/laser_ground_closer.hpp"

namespace cairn {
namespace {

Result<std::unique_ptr<Frontend>> load_plugin(const std::string& path) {
  const auto refuse = [&](const std::string& why) { return Error{ErrorCode::kUsage, why, path}; };
  // Without a '/' it would be looked for in the system's folders.
  const std::string file = path.find('/') == std::string::npos ? "./" + path : path;
  void* const object = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (object == nullptr) return refuse(std::string("cannot be loaded: ") + dlerror());
  const auto* plugin = static_cast<const FrontendPlugin*>(dlsym(object, "cairn_frontend_plugin"));
  if (plugin == nullptr)
    return refuse("is no front-end: it exports no cairn_frontend_plugin (frontends/api)");
  if (plugin->version != FrontendPlugin::kVersion)
    return refuse("is made for version " + std::to_string(plugin->version) +
                  " of the front-end interface; this host has version " +
                  std::to_string(FrontendPlugin::kVersion) + ": compile it anew");
  std::unique_ptr<Frontend> frontend(plugin->make == nullptr ? nullptr : plugin->make());
  if (!frontend) return refuse("makes no front-end");
  return frontend;
}

}  // namespace

Result<std::unique_ptr<Frontend>> make_frontend(const std::string& name,
                                                const FrontendRoles& roles) {
  if (name == "laser" && !roles.tracker)
    return std::unique_ptr<Frontend>(std::make_unique<LaserGroundCloser>());
  if (name == "laser") return std::unique_ptr<Frontend>(std::make_unique<LaserFrontend>());
  if (name.find('/') != std::string::npos || name.ends_with(".so")) return load_plugin(name);
  return Error{ErrorCode::kUsage, "unknown front-end '" + name.substr(0, 60) +
                                      "'; expected laser, or the path of a shared object"};
}

}  // namespace cairn
