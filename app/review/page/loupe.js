// The contact point, enlarged, in the frame that is shown.
import {Picture} from './picture.js';

const kShare = 0.7;       // of the body's size that is seen
const kLeastWidth_px = 14;

export class Loupe extends Picture {
  constructor(width, height, frameUrl) {
    super(width, height, frameUrl, 'The contact point, enlarged', () => {});
    this.node.setAttribute('class', 'loupe');
    this.node.setAttribute('role', 'img');
    this.aspect = 1;
    this.mark_permille = 25;
  }

  show(view, moved, leftOut) {
    const at = view.contact?.touching_px;
    this.node.classList.toggle('absent', !at);
    if (at) {
      const body = view.body;
      const size = body.kind === 'sphere' ? 2 * body.radius_px
                                          : 2 * body.half_short_px;
      this.zoomTo(at[0], at[1], Math.max(kLeastWidth_px, size * kShare));
    }
    super.show(view, moved, leftOut);
  }

  // Nothing is moved or dragged here.
  onWheel() {}
  onPan() {}
  drawHandles() {}
}
