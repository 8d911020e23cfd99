// print_board: a fiducial board as a PDF of true size.

#include <cairo-pdf.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <stdexcept>

#include "rgbd_recognition/training/fiducial_board.h"

namespace recognition {
namespace {

constexpr double kPoint = 0.0254 / 72.0;  // PDF's unit, metres
constexpr double kMargin = 0.012;         // of a page that printers leave white, metres
constexpr double kScaleBar = 0.1;         // metres

const std::map<std::string, Eigen::Vector2d> kPapers = {{"a4", {0.210, 0.297}},
                                                        {"a3", {0.297, 0.420}},
                                                        {"a2", {0.420, 0.594}},
                                                        {"a1", {0.594, 0.841}},
                                                        {"letter", {0.2159, 0.2794}}};

// Pages of one PDF, drawn in metres from their lower left corner.
class Pdf {
 public:
  Pdf(const std::string& file, const Eigen::Vector2d& page)
      : file_(file),
        page_(page),
        surface_(cairo_pdf_surface_create(file.c_str(), page.x() / kPoint, page.y() / kPoint), cairo_surface_destroy),
        context_(cairo_create(surface_.get()), cairo_destroy) {}

  void beginPage() {
    cairo_identity_matrix(context_.get());
    cairo_scale(context_.get(), 1.0 / kPoint, -1.0 / kPoint);
    cairo_translate(context_.get(), 0.0, -page_.y());
    cairo_set_antialias(context_.get(), CAIRO_ANTIALIAS_NONE);
  }
  void endPage() { cairo_show_page(context_.get()); }

  void fill(const Eigen::Vector2d& corner, const Eigen::Vector2d& size) {
    cairo_rectangle(context_.get(), corner.x(), corner.y(), size.x(), size.y());
    cairo_fill(context_.get());
  }
  // What is filled from now on shows inside of it only, until unclip().
  void clip(const Eigen::Vector2d& corner, const Eigen::Vector2d& size) {
    cairo_save(context_.get());
    cairo_rectangle(context_.get(), corner.x(), corner.y(), size.x(), size.y());
    cairo_clip(context_.get());
  }
  void unclip() { cairo_restore(context_.get()); }

  void write(const Eigen::Vector2d& at, const std::string& text) {
    cairo_save(context_.get());
    cairo_move_to(context_.get(), at.x(), at.y());
    cairo_scale(context_.get(), 1.0, -1.0);
    cairo_select_font_face(context_.get(), "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(context_.get(), 0.003);
    cairo_show_text(context_.get(), text.c_str());
    cairo_restore(context_.get());
  }

  // Throws std::runtime_error if the file could not be written.
  void finish() {
    cairo_surface_finish(surface_.get());
    for (const cairo_status_t status : {cairo_status(context_.get()), cairo_surface_status(surface_.get())})
      if (status != CAIRO_STATUS_SUCCESS) throw std::runtime_error(file_ + ": " + cairo_status_to_string(status));
  }

 private:
  std::string file_;
  Eigen::Vector2d page_;
  std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface_;
  std::unique_ptr<cairo_t, decltype(&cairo_destroy)> context_;
};

// The part of the board from `corner` (board frame) on, in a page's printable part.
void drawPart(const FiducialBoard& board, const Eigen::Vector2d& corner, const Eigen::Vector2d& size,
              const std::string& title, Pdf& pdf) {
  const Eigen::Vector2d origin(kMargin, kMargin);
  pdf.beginPage();
  pdf.clip(origin, size);
  for (const FiducialBoard::DarkArea& area : board.darkAreas()) pdf.fill(area.corner - corner + origin, area.size);
  pdf.unclip();
  const double thin = 0.0002, mark = 0.006;
  for (const double x : {origin.x(), origin.x() + size.x()})  // where to cut
    for (const double y : {origin.y(), origin.y() + size.y()}) {
      pdf.fill({x - thin / 2, y < kMargin + 1e-9 ? y - mark : y}, {thin, mark});
      pdf.fill({x < kMargin + 1e-9 ? x - mark : x, y - thin / 2}, {mark, thin});
    }
  pdf.fill({origin.x(), 0.006}, {kScaleBar, 0.0006});
  pdf.write({origin.x() + kScaleBar + 0.003, 0.005}, "the bar is 100 mm long: measure it.  " + title);
  pdf.endPage();
}

void print(const FiducialBoard& board, const std::string& paper, const std::string& title, const std::string& file) {
  const Eigen::Vector2d margins(2.0 * kMargin, 2.0 * kMargin);
  Eigen::Vector2d page = board.size() + margins;
  if (paper != "board") page = kPapers.at(paper);
  const Eigen::Vector2d part = (page - margins).cwiseMin(board.size());
  const int columns = static_cast<int>(std::ceil(board.size().x() / part.x() - 1e-9)),
            rows = static_cast<int>(std::ceil(board.size().y() / part.y() - 1e-9));
  Pdf pdf(file, page);
  const Eigen::Vector2d upper_left(-0.5 * board.size().x(), 0.5 * board.size().y());
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const Eigen::Vector2d corner = upper_left + Eigen::Vector2d(column * part.x(), -(row + 1) * part.y());
      drawPart(board, corner, part,
               title + ", row " + std::to_string(row + 1) + " of " + std::to_string(rows) + ", column " +
                   std::to_string(column + 1) + " of " + std::to_string(columns),
               pdf);
    }
  pdf.finish();
  std::printf("%s: %d pages of %.0f x %.0f mm; print them at 100 %%, measure the bar\n", file.c_str(), rows * columns,
              1000.0 * page.x(), 1000.0 * page.y());
}

int main(int argc, char** argv) {
  std::string board, paper = "board", out;
  CLI::App app("A fiducial board as a PDF of true size, on one sheet or on several to be cut along their marks.");
  app.add_option("--board", board, "config/boards/*.yaml")->required()->check(CLI::ExistingFile);
  app.add_option("--paper", paper, "one sheet as large as the board, or a printer's paper")
      ->check(CLI::IsMember({"board", "a4", "a3", "a2", "a1", "letter"}))
      ->capture_default_str();
  app.add_option("--out", out, "PDF to write")->required();
  try {
    app.parse(argc, argv);
    const FiducialBoard described = FiducialBoard::fromYaml(board);
    print(described, paper, described.name(), out);
    return 0;
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "print_board: %s\n", error.what());
    return 1;
  }
}

}  // namespace
}  // namespace recognition

int main(int argc, char** argv) { return recognition::main(argc, argv); }
