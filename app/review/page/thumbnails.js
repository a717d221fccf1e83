// Small pictures of a list: those in sight, one after the other, so that a long
// list asks the server for no more than a person sees.

const wanted = new Set();
let busy = false;

async function loadNext() {
  if (busy) return;
  busy = true;
  while (wanted.size > 0) {
    const [image] = wanted;
    wanted.delete(image);
    if (!image.isConnected) continue;
    image.src = image.dataset.src;
    seen.unobserve(image);
    // A recording that is gone has none.
    await image.decode().catch(() => image.removeAttribute('src'));
  }
  busy = false;
}

const seen = new IntersectionObserver(entries => {
  for (const {target, isIntersecting} of entries) {
    if (isIntersecting) wanted.add(target);
    else wanted.delete(target);
  }
  loadNext();
});

export function watchThumbnail(image) { seen.observe(image); }
