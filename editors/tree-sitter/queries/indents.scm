[
  (plan)
  (loop)
  (string)
  (formal)
  (atom)
] @indent.begin

["}" "\\}" ")"] @indent.branch @indent.end

(block_comment) @indent.ignore
