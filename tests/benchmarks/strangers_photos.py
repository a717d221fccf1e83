"""The photographs of composite.py as its STRANGERS_PHOTOS wants them; for `strangers`.

usage: strangers_photos.py GENERATORS ROOT usual|other

usual: those that composite.py names itself; other: pictures of the same two Debian
packages, opencv-doc and mate-backgrounds, that it does not use. A picture that is not
where the package puts it (documentation may be left out) is taken from the package
unpacked in ROOT.
"""
import json
import os
import sys

DATA = '/usr/share/doc/opencv-doc/examples/data/'
HTML = '/usr/share/doc/opencv-doc/opencv4/html/'
MATE = '/usr/share/backgrounds/mate/'

OTHER_WALLS = [
    MATE + 'nature/Aqua.jpg', MATE + 'nature/TwoWings.jpg', MATE + 'nature/FreshFlower.jpg',
    MATE + 'nature/YellowFlower.jpg', MATE + 'abstract/Elephants_3840x2160.jpg',
    DATA + 'starry_night.jpg', DATA + 'stuff.jpg', DATA + 'cards.png', DATA + 'left03.jpg',
    DATA + 'rubberwhale1.png', DATA + 'box_in_scene.png',
    HTML + 'retina_TreeHdr_retina.jpg', HTML + 'opencv_bus_res.jpg', HTML + 'pattern_img.jpg',
    HTML + 'fusion_mertens.jpg', HTML + 'gbocclusion.png', HTML + 'corridor_fld.jpg',
    HTML + 'detect_test2.jpg', HTML + 'singlemarkersoriginal.jpg', HTML + '4_barcodes.jpg',
    HTML + 'newspaper.jpg',
]
OTHER_GROUNDS = [
    MATE + 'nature/LadyBird.jpg', MATE + 'abstract/Gulp.png', DATA + 'smarties.png',
    DATA + 'starry_night.jpg', DATA + 'rubberwhale2.png', DATA + 'sudoku.png', DATA + 'aero1.jpg',
    HTML + 'gdal_output.jpg', HTML + 'demo.jpg', HTML + 'affinepano.jpg',
    HTML + 'random_pattern.jpg', HTML + 'reconstructed_fastVSbest.jpg',
]
OTHER_FACES = [
    DATA + 'box.png', DATA + 'HappyFish.jpg', DATA + 'orange.jpg', DATA + 'squirrel_cls.jpg',
    DATA + 'basketball1.png', DATA + 'text_defocus.jpg', DATA + 'imageTextN.png',
    DATA + 'licenseplate_motion.jpg', DATA + 'ela_original.jpg', DATA + 'cards.png',
    DATA + 'sudoku.png', DATA + 'aero3.jpg',
    HTML + 'Hough_Circle_Tutorial_Result.png', HTML + 'acircles_pattern.png',
    HTML + 'checkershadow_illusion4med.jpg', HTML + 'plant.jpg', HTML + 'realsense.jpg',
    HTML + 'pca_output.png', HTML + 'choriginal.jpg', HTML + 'eigenface_reconstruction_opencv.png',
]


def main():
    generators, root, which = sys.argv[1:]
    sys.path.insert(0, generators)
    import composite

    def found(path):
        return path if os.path.exists(path) else root + path

    lists = {'usual': (composite.WALLS, composite.GROUNDS, composite.FACES),
             'other': (OTHER_WALLS, OTHER_GROUNDS, OTHER_FACES)}[which]
    print(json.dumps([[found(path) for path in paths] for paths in lists]))


if __name__ == '__main__':
    main()
