[
  (plan)
  (loop)
  (string)
  (formal)
  (block_comment)
] @fold
