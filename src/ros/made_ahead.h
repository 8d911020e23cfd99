#pragma once

#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>

#include "rgbd_recognition/model/object_model.h"

namespace recognition {

/// What a stage makes of the models, such as an index over them: made ahead of new models by the thread that loads
/// them, so that the frame that meets them first need not wait. Keeps what it made of the last two databases, as frames
/// in work still use the earlier one. Safe to use from several threads.
template <typename Product>
class MadeAhead {
 public:
  using Database = std::shared_ptr<const ModelDatabase>;
  using Recipe = std::function<std::shared_ptr<const Product>(const Database&)>;

  /// How it is made from now on; `product` is what the recipe makes of `database`, where that was tried already.
  void setRecipe(const Recipe& recipe, const Database& database = nullptr,
                 const std::shared_ptr<const Product>& product = nullptr) {
    const std::lock_guard<std::mutex> lock(mutex_);
    recipe_ = recipe;
    ++recipe_number_;
    made_.clear();
    if (product) made_.push_back({database, product});
  }

  /// For ModelSource::beforeSwap(): makes it ahead, and keeps `made_ahead` for as long. A recipe that fails is left to
  /// get(), which tells of it.
  static std::function<void(const Database&)> preparation(const std::shared_ptr<MadeAhead>& made_ahead) {
    return [made_ahead](const Database& database) {
      try {
        made_ahead->get(database);
      } catch (const std::exception&) {
      }
    };
  }

  /// Of this database: made ahead, or made now. Throws what the recipe throws.
  std::shared_ptr<const Product> get(const Database& database) {
    Recipe recipe;
    int number = 0;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      for (const Made& made : made_)
        if (made.database == database) return made.product;
      recipe = recipe_;
      number = recipe_number_;
    }
    const auto product = recipe ? recipe(database) : nullptr;
    const std::lock_guard<std::mutex> lock(mutex_);
    if (product && number == recipe_number_) made_.push_back({database, product});
    if (made_.size() > kKept) made_.pop_front();
    return product;
  }

 private:
  struct Made {
    Database database;
    std::shared_ptr<const Product> product;
  };
  static constexpr size_t kKept = 2;

  std::mutex mutex_;  // guards all below; not held while making
  Recipe recipe_;
  int recipe_number_ = 0;
  std::deque<Made> made_;
};

}  // namespace recognition
