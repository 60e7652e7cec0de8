//! Regions of tokens that a single error may affect. A region is an outermost parenthesis within its innermost brace,
//! or the tokens on one line between two such parentheses. Only the first error in a region is reported.

/// Regions of a text. They are determined while the tokens are being read.
#[derive(Debug)]
pub(super) struct Regions {
    /// Region of each token.
    of_token: Vec<usize>,
    /// For each region, `true` if an error in it has been reported.
    spoiled: Vec<bool>,
    /// Region of the next token.
    current: usize,
    /// Number of open parentheses around the next token, counted within its innermost brace.
    depth: usize,
    /// Region and depth at each open brace.
    around: Vec<(usize, usize)>,
}

impl Default for Regions {
    fn default() -> Self {
        Self { of_token: Vec::new(), spoiled: vec![false], current: 0, depth: 0, around: Vec::new() }
    }
}

impl Regions {
    /// Assigns the next token to the current region.
    pub(super) fn push(&mut self) {
        self.of_token.push(self.current);
    }

    /// Records that an error in the current region has been reported.
    pub(super) fn spoil(&mut self) {
        if let Some(spoiled) = self.spoiled.get_mut(self.current) {
            *spoiled = true;
        }
    }

    /// Records an error in the region of this token. Returns `true` if an error in this region had already been
    /// reported.
    pub(super) fn is_spoiled_once(&mut self, token: usize) -> bool {
        let region = self.of_token.get(token).or(self.of_token.last()).copied().unwrap_or(0);
        self.spoiled.get_mut(region).is_some_and(|spoiled| std::mem::replace(spoiled, true))
    }

    /// Records that a reported error also affects the region of this token.
    pub(super) fn spoil_at(&mut self, token: usize) {
        self.is_spoiled_once(token);
    }

    /// Returns `true` if an error in the region of this token has been reported.
    pub(super) fn is_spoiled(&self, token: usize) -> bool {
        let region = self.of_token.get(token).copied();
        region.and_then(|region| self.spoiled.get(region)).copied().unwrap_or(false)
    }

    /// Records that the next token begins a line.
    pub(super) fn begin_line(&mut self) {
        if self.depth == 0 {
            self.begin();
        }
    }

    /// Records that the next token opens a parenthesis.
    pub(super) fn open_parenthesis(&mut self) {
        if self.depth == 0 {
            self.begin();
        }
        self.depth += 1;
    }

    /// Records that the last token closed a parenthesis.
    pub(super) fn close_parenthesis(&mut self) {
        self.depth = self.depth.saturating_sub(1);
        if self.depth == 0 {
            self.begin();
        }
    }

    /// Records that the last token opened a brace.
    pub(super) fn open_brace(&mut self) {
        self.around.push((self.current, self.depth));
        self.depth = 0;
        self.begin();
    }

    /// Records that the last token closed a brace.
    pub(super) fn close_brace(&mut self) {
        (self.current, self.depth) = self.around.pop().unwrap_or((0, 0));
        if self.depth == 0 {
            self.begin();
        }
    }

    fn begin(&mut self) {
        self.current = self.spoiled.len();
        self.spoiled.push(false);
    }
}
