// Compiled to see whether OpenCV's archives link: what we use of each.
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

int main() {
  cv::Mat image(64, 64, CV_8U, cv::Scalar(0));
  cv::blur(image, image, {3, 3});
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(image, outlines, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
  std::vector<cv::Point2f> corners;
  cv::findChessboardCornersSB(image, {3, 3}, corners);
  cv::findCirclesGrid(image, {3, 3}, corners);
  std::vector<std::vector<cv::Point3f>> board;
  std::vector<std::vector<cv::Point2f>> seen;
  cv::Mat camera;
  cv::Mat distortion;
  std::vector<cv::Mat> turns;
  std::vector<cv::Mat> shifts;
  cv::calibrateCamera(board, seen, image.size(), camera, distortion, turns,
                      shifts);
}
