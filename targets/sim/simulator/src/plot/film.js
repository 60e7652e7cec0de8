
(function () {
  'use strict';
  var picture = document.currentScript.parentNode;
  var find = function (name) { return picture.querySelector('.' + name); };
  var strip = find('strip'), now = find('now'), button = find('button'), playing = find('playing'), paused = find('paused');
  var number = function (name) { return Number(strip.getAttribute('data-' + name)); };
  var end = number('end'), times = number('times'), round = number('round'), left = number('left'), right = number('right');
  var held = false;
  var time = function () { return Math.min(picture.getCurrentTime() % round * times, end); };
  var seek = function (t) { picture.setCurrentTime(Math.max(0, Math.min(t, end)) / times); };
  var hold = function () {
    if (picture.animationsPaused()) { picture.unpauseAnimations(); } else { picture.pauseAnimations(); }
  };
  var follow = function (event) {
    var at = new DOMPoint(event.clientX, event.clientY).matrixTransform(picture.getScreenCTM().inverse());
    seek((at.x - left) / (right - left) * end);
  };
  var show = function () {
    now.textContent = time().toFixed(1) + ' s of ';
    playing.setAttribute('visibility', picture.animationsPaused() ? 'hidden' : 'visible');
    paused.setAttribute('visibility', picture.animationsPaused() ? 'visible' : 'hidden');
    requestAnimationFrame(show);
  };
  strip.addEventListener('pointerdown', function (event) {
    held = true;
    strip.setPointerCapture(event.pointerId);
    follow(event);
  });
  strip.addEventListener('pointermove', function (event) { if (held) { follow(event); } });
  strip.addEventListener('pointerup', function () { held = false; });
  button.addEventListener('click', hold);
  document.addEventListener('keydown', function (event) {
    var step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (step) { seek(time() + step * end / 100); } else if (event.key === ' ') { hold(); } else { return; }
    event.preventDefault();
  });
  button.setAttribute('visibility', 'visible');
  strip.setAttribute('cursor', 'pointer');
  show();
}());
