-- Neovim with the lines of the page "Editors": opens a plan, and shows what the server answers. The screen is written to
-- the file `screen.txt` of the working directory.

local plan = '{ Leg (bumper)\n  (Atom (wait 5) (go   20 0))\n}\n\n{ P (wait 1min)\n  Leg\n  (Atom (null) trun 90)\n}\n'
local path = vim.fn.getcwd() .. '/plan.mdle'

local function check(is_so, what)
  if not is_so then error(what, 2) end
end

-- The text of the screen, as a person sees it.
local function screen()
  vim.cmd('redraw')
  local rows = {}
  for row = 1, vim.o.lines do
    local cells = {}
    for column = 1, vim.o.columns do cells[#cells + 1] = vim.fn.screenstring(row, column) end
    rows[#rows + 1] = (table.concat(cells):gsub('%s+$', ''))
  end
  return table.concat(rows, '\n')
end

-- Waits until a function returns something.
local function wait(what, get)
  local found
  local came = vim.wait(10000, function() found = get() return found ~= nil and found ~= false end, 50)
  check(came, what .. ' did not come:\n' .. screen())
  return found
end

-- Sends a request to the server, and returns its result.
local function ask(method, params)
  local answers = vim.lsp.buf_request_sync(0, method, params, 20000)
  for _, answer in pairs(answers or {}) do
    check(answer.err == nil, method .. ': ' .. vim.inspect(answer.err))
    return answer.result
  end
  error(method .. ' was not answered')
end

-- Puts the cursor on a word.
local function on(word, offset)
  local position = vim.fn.searchpos('\\C' .. word, 'w')
  check(position[1] > 0, word .. ' is not in the plan')
  vim.api.nvim_win_set_cursor(0, { position[1], position[2] - 1 + (offset or 0) })
  return vim.lsp.util.make_position_params(0, 'utf-16')
end

local function lines() return table.concat(vim.api.nvim_buf_get_lines(0, 0, -1, false), '\n') end

local function run()
  local file = io.open(path, 'w')
  file:write(plan)
  file:close()
  vim.o.lines, vim.o.columns = 30, 110
  vim.cmd('edit ' .. path)
  check(vim.bo.filetype == 'mdle', 'the file type is ' .. vim.bo.filetype)

  local diagnostics = wait('diagnostics', function()
    local found = vim.diagnostic.get(0)
    return #found > 0 and found
  end)
  check(diagnostics[1].lnum == 6 and diagnostics[1].message:find('trun'), vim.inspect(diagnostics))
  local shown = screen()
  check(shown:find('trun') and shown:find('there is no law'), shown)

  local hover = ask('textDocument/hover', on('go   20'))
  check(vim.inspect(hover.contents):find('go'), vim.inspect(hover))
  vim.lsp.buf.hover()
  -- The window closes when the cursor moves, which Neovim notices when it draws.
  local window = wait('the window of the hover', function()
    for _, window in ipairs(vim.api.nvim_list_wins()) do
      if vim.api.nvim_win_get_config(window).relative ~= '' then return window end
    end
  end)
  local text = table.concat(vim.api.nvim_buf_get_lines(vim.api.nvim_win_get_buf(window), 0, -1, false), '\n')
  check(text:find('cm/s'), text)
  shown = screen()
  local out = io.open('screen.txt', 'w')
  out:write(shown, '\n')
  out:close()

  on('trun', 2)
  local completion = ask('textDocument/completion', vim.lsp.util.make_position_params(0, 'utf-16'))
  local labels = vim.tbl_map(function(item) return item.label end, completion.items or completion)
  check(vim.tbl_contains(labels, 'turn') and not vim.tbl_contains(labels, 'bumper'), vim.inspect(labels))
  vim.cmd('%s/trun/turn/')
  wait('a plan without errors', function()
    return #vim.diagnostic.get(0, { severity = vim.diagnostic.severity.ERROR }) == 0
  end)

  on('Leg$')
  vim.lsp.buf.rename('Stretch')
  wait('the new name', function() return lines():find('{ Stretch %(bumper%)') and lines():find('\n  Stretch\n') end)

  if vim.lsp.buf.format then
    vim.lsp.buf.format({ timeout_ms = 20000 })
  else -- Neovim 0.7
    vim.lsp.buf.formatting_sync(nil, 20000)
  end
  check(lines():find('%(go 20 0%)'), lines())
end

local done, reason = pcall(run)
if not done then io.stderr:write(tostring(reason), '\n') end
vim.cmd(done and 'qall!' or 'cquit!')
