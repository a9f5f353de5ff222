// SPDX-License-Identifier: Apache-2.0
// The visibility of an error that is known by its size only: before there is a reference, and before the
// samples are drawn. It is FovVideoVDP (fovvideovdp.hpp) with the *expected* squared error of every pixel in place of a
// second picture, so it predicts the result of that metric.
//
// The model. Let e be the error of a frame's displayed luminance: normally distributed about 0, of variance v(x) at
// pixel x, with a spectrum and a correlation over time that are given. FovVideoVDP splits it into the bands b of a
// Laplacian pyramid and into a sustained and a transient channel c (Mantiuk et al., ACM TOG 40(4), 2021, sections 3.2
// to 3.6). There the error is a multiple of the threshold that has the standard deviation
//   s_bc(x) = gain_b S_bc(x) sqrt(g_b t_c v_b(x)) / L_b(x),
// where S is the contrast sensitivity at this frequency, eccentricity and luminance L_b, g_b the spectrum's gain (the
// variance of band b over that of a pixel), t_c the channel's gain in variance for errors of this correlation in time,
// v_b the variance smoothed to the band's resolution, and gain_b is 1 in the finest band and 2 in the others. With u,
// the band's contrast in the picture itself in multiples of the threshold, the expectation of the metric's masked
// difference to the power that it is pooled with is
//   a_bc(x) = E[(min(|s z|^2.4 / (1 + m^q), 10000))^r],  m = k min(|u|, |u + s z|),  z normal,  r = 1.52134,
// and then, as in the metric, Q_bc = (mean of a_bc over the pixels)^(1/r), a sum over the bands, the channels pooled
// with 0.666, the mean over frames, and JOD = 10 - 0.0161713 Q^0.5916.
//
// It leaves out: errors whose distribution has heavier tails than the normal one (at a few samples a pixel they
// are more visible than predicted, above all in the finest band), contrast of the picture over time, which masks the
// transient channel, and errors of colour at equal luminance.
//
// How to use it, for a frame of which a pilot is known:
//   const VisibleErrorModel model({request.view, fps});                      // once for all frames of one view
//   const DisplayCurve curve = view_display_curve(color, photometry, ev);    // or linear_display_curve()
//   const VisiblePicture picture{luminance, curve, request.gaze_direction_render};
//   const VisibleFrame visible = model.predict(picture, {{squared_error}});  // Q, and by it JOD
//   const ImageGray weights = model.weights(picture, {{squared_error}});
//   const ImageGray density = visible_allocation(weights, variance_of_one_sample);
// All pictures are of one size. Results have the same bits for any number of threads.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "gazetrace/color.hpp"
#include "gazetrace/display.hpp"
#include "gazetrace/fovvideovdp.hpp"
#include "gazetrace/image.hpp"

namespace gazetrace {

// The exponent with which FovVideoVDP pools contrast over the pixels of a band: 2.4 of the masked difference times
// 1.52134 of the pooling.
inline constexpr double kVisiblePooling = 2.4 * 1.52134;

// ---- The error

// How the variance of an error is spread over the bands of FovVideoVDP's pyramid, finest first: the variance of the
// band's values over the variance of the pixels. Bands do not share out a whole: those of white noise have 0.876, 0.060
// and 0.0113, and then about a quarter of the one before. Where the even and the odd pixels of a band differ, because
// the pyramid interpolates between them, the gain is the mean that pools to the same: (mean of gain^(p/2))^(2/p), p =
// kVisiblePooling.
inline constexpr std::size_t kMostVisibleBands = 15;
struct ErrorSpectrum {
  std::array<double, kMostVisibleBands> gain{};
};
// Independent pixels.
ErrorSpectrum white_error();
// One value for each block of block_px x block_px pixels, independent from block to block.
ErrorSpectrum block_error(int block_px);
// White noise after a Gaussian of this standard deviation, which takes place before the error's variance is counted.
ErrorSpectrum low_pass_error(double sigma_px);
// White noise whose power is multiplied by `factor` below a frequency. The gains are relative to the variance of the
// white noise *before* the cut. The frequency is radial, in cycles per degree.
ErrorSpectrum cut_error(double below_cpd, double factor, double pixels_per_degree);
// The power of a sample of the error in each band, for example of half the difference of two independent halves of the
// samples. The sample should be divided by the picture's luminance; its mean and its border are left out.
ErrorSpectrum measured_spectrum(const ImageGray& error, int threads = 0);

// An error that has several causes is a list of these; they are independent of each other, and their variances add up
// band by band. So fresh noise and a filter's standing bias are two components, as are the noise of single pixels in
// the fovea and that of blocks in the periphery (each with 0 where the other is).
struct ErrorComponent {
  // The expected squared error of each pixel's luminance, in the square of VisiblePicture::luminance's unit. Negative
  // and infinite values count as 0.
  ImageGray squared_error;
  ErrorSpectrum spectrum = white_error();
  // From one frame to the next, in 0..1; over more frames it falls geometrically. 0: fresh noise in every frame, which
  // flickers. 1: frozen noise and standing bias, which only the sustained channel sees. An exponential mean that gives
  // the newest frame the weight alpha leaves 1 - alpha.
  double correlation = 0;
};

// ---- The picture

// How scene-linear luminance becomes luminance of the display: a curve that does not fall. Errors pass through it with
// the finite difference (curve(Y + s) - curve(Y - s)) / 2 of their own standard deviation s, so that errors clipped by
// a view or a display do not count as visible.
struct DisplayCurve {
  // cd/m2 at the scene luminances 0, and 2^(kLeastLog2 + i / kStepsPerStop); linear between them, constant
  // above.
  static constexpr int kLeastLog2 = -20, kMostLog2 = 20, kStepsPerStop = 8;
  double black_cd_m2 = 0;
  std::vector<float> cd_m2;
  [[nodiscard]] float operator()(float scene_luminance) const;
};
// black + (peak - black) min(1, Y 2^ev), as for a display of linear response.
DisplayCurve linear_display_curve(const DisplayPhotometry& photometry, double exposure_ev);
// Grey of each luminance through the view at this exposure, and through the display as FovVideoVDP sees it
// (display_luminance()). Views that mix colours treat saturated ones otherwise; this is left out.
DisplayCurve view_display_curve(const ColorPipeline& color, const DisplayPhotometry& photometry, double exposure_ev);

// Refers to its parts, which must outlive it.
struct VisiblePicture {
  const ImageGray& luminance;  // scene-linear, unexposed (Rec.709); an estimate will do
  const DisplayCurve& display;
  // From the eye, in its frame, as in FrameRequest; empty: the fovea may be anywhere, and its sensitivity holds
  // everywhere (FovVideoVDP's mode without foveation).
  std::optional<Vec3d> gaze_direction = std::nullopt;
  // Whether `luminance` contains an error like that of the components, as a noisy pilot does. Then its contrast counts
  // as masking only so far as it exceeds the error's own contrast. Where pictures are given in cells, the value of each
  // is taken to hold the error of a single pixel, as in a pilot that shows every cell_px-th pixel.
  bool holds_the_error = true;
  // How many frames the clip has had before this one; empty: more than 250 ms. FovVideoVDP takes a clip to have stood
  // still before its first frame, so that fresh noise appears frozen there.
  std::optional<int> frames_before = std::nullopt;
};

// ---- The model

struct VisibleErrorSettings {
  PlanarView view;               // of the frame
  double frames_per_second = 0;  // 0: a still, which has no transient channel
  // Pictures may be given at a lower resolution: each of their pixels is the mean over cell_px x cell_px pixels of the
  // frame (at the right and lower border over fewer pixels), a power of two. Spectra are still those of the
  // frame's pixels, and squared errors those of single pixels. Bands finer than a cell are computed as well, without
  // masking by a contrast that is not known.
  int cell_px = 1;
  int threads = 0;
};

struct VisibleFrame {
  double q = 0;                              // FovVideoVDP's Q; fovvideovdp_jod(q) is the JOD of a clip of such frames
  std::vector<double> sustained, transient;  // Q of each band, finest first; transient is empty for stills
  // The visible error of each pixel: its share of Q, pooled over bands and channels so that the mean over the pixels is
  // q, and so that where q would change most per unit of variance, the density is highest. Empty unless asked for.
  ImageGray density;
};

class VisibleErrorModel {
 public:
  // Error(usage) for frames of less than 8 pixels a side, for a cell_px that is no power of two, and for frame rates
  // that FovVideoVDP refuses.
  explicit VisibleErrorModel(const VisibleErrorSettings& settings);
  ~VisibleErrorModel();
  VisibleErrorModel(VisibleErrorModel&&) noexcept;
  VisibleErrorModel& operator=(VisibleErrorModel&&) noexcept;
  VisibleErrorModel(const VisibleErrorModel&) = delete;
  VisibleErrorModel& operator=(const VisibleErrorModel&) = delete;

  // Size of the pictures that it takes.
  [[nodiscard]] int width_px() const;
  [[nodiscard]] int height_px() const;
  [[nodiscard]] const std::vector<double>& band_frequencies_cpd() const;

  // Error(usage) for pictures of another size.
  [[nodiscard]] VisibleFrame predict(const VisiblePicture& picture, const std::vector<ErrorComponent>& errors,
                                     bool want_density = false) const;

  // The visible error per unit of error: w(x), such that w times the root of the squared error (in the luminance's own
  // unit) is the visible error at x, and the mean of (w e)^kVisiblePooling over the pixels is Q, about: w is smooth
  // over the bands in which the error is seen. Times the luminance it is the weight of the *relative* error. It counts
  // for errors about as large as those given; without any, a white, fresh one of a tenth of the luminance is assumed.
  // Positive and finite.
  [[nodiscard]] ImageGray weights(const VisiblePicture& picture, const std::vector<ErrorComponent>& errors) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// JOD of a clip: FovVideoVDP takes the mean over the frames in Q. NaN without frames.
double visible_jod(const std::vector<double>& q_of_frames);

// ---- Where samples belong

// The best relative rates for pooled visible error. With n(x) samples a pixel the squared error is v(x) / n(x), v that
// of one sample. To be minimised, at a given sum of n, is
//   sum of (w^2 v / n)^(b/2),  b = kVisiblePooling.
// Setting the derivative by n to one constant everywhere gives (w^2 v)^(b/2) n^(-b/2 - 1) = constant, and so
//   n ~ (w^2 v)^((b/2) / (1 + b/2)),
// an exponent of 0.646 of w^2 v, or 1.29 of the visible error w sqrt(v). (With b = 2, the plain sum of squared errors,
// it is Neyman's allocation, n ~ w sqrt(v).)
// `weights` and the variance are in the same unit: both of the luminance itself, or both relative. The result has a
// mean of 1 and is nowhere below kLeastAllocation; negative and infinite values count as 0; where everything is 0,
// it is 1. Error(usage) where the sizes differ.
inline constexpr float kLeastAllocation = 1e-4F;
ImageGray visible_allocation(const ImageGray& weights, const ImageGray& variance_of_one_sample, int threads = 0);

// How many times the samples of visible_allocation() a uniform rate needs for the same pooled visible error, with
// e = w sqrt(v): (mean of e^b)^(2/b) / (mean of e^(b/(1 + b/2)))^((1 + b/2) 2/b). At least 1.
double allocation_gain(const ImageGray& weights, const ImageGray& variance_of_one_sample, int threads = 0);

}  // namespace gazetrace
