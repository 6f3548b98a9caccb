// The phrases of a page's scripts, in the language of the page, which brings them along.
"use strict";

const say = (() => {
  const phrases = JSON.parse(document.querySelector("meta[name=words]").content);

  /** The phrase with this id, with these values in it. */
  return (id, values = {}) => phrases[id].replace(/\{ \$(\w+) \}/g, (_, name) => values[name]);
})();
