#include "touchdown/vision/footage/video_decoders.h"

#include "footage/formats/libav.h"

namespace touchdown::vision {

std::vector<VideoDecoder> VideoDecoders() {
  std::vector<VideoDecoder> codecs;
  for (const AVCodecID id :
       {AV_CODEC_ID_RAWVIDEO, AV_CODEC_ID_MJPEG, AV_CODEC_ID_H264,
        AV_CODEC_ID_HEVC, AV_CODEC_ID_FFV1, AV_CODEC_ID_PRORES,
        AV_CODEC_ID_HUFFYUV, AV_CODEC_ID_MPEG4, AV_CODEC_ID_MPEG2VIDEO,
        AV_CODEC_ID_DVVIDEO, AV_CODEC_ID_VP9}) {
    codecs.push_back({Libav().avcodec_get_name(id),
                      Libav().avcodec_find_decoder(id) != nullptr});
  }
  return codecs;
}

}  // namespace touchdown::vision
